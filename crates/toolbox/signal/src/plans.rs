//! Plans of Fourier transforms, kept from one call to the next: planning a length takes longer than one transform of
//! it.

use std::cell::RefCell;
use std::sync::Arc;

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

/// Lengths whose plans each thread keeps; a plan takes some tens of bytes for each sample.
const KEPT: usize = 4;

type Forward = Arc<dyn RealToComplex<f64>>;
type Inverse = Arc<dyn ComplexToReal<f64>>;

thread_local! {
    /// The length used last comes last.
    static FORWARD: RefCell<Vec<(usize, Forward)>> = const { RefCell::new(Vec::new()) };
    static INVERSE: RefCell<Vec<(usize, Inverse)>> = const { RefCell::new(Vec::new()) };
}

/// The transform of real signals of this length.
pub(crate) fn forward(length: usize) -> Forward {
    work::checkpoint();
    FORWARD.with_borrow_mut(|kept| of(kept, length, || RealFftPlanner::new().plan_fft_forward(length)))
}

/// The way back to a real signal of this length.
pub(crate) fn inverse(length: usize) -> Inverse {
    work::checkpoint();
    INVERSE.with_borrow_mut(|kept| of(kept, length, || RealFftPlanner::new().plan_fft_inverse(length)))
}

fn of<P: Clone>(kept: &mut Vec<(usize, P)>, length: usize, planned: impl FnOnce() -> P) -> P {
    let known = kept.iter().position(|(of, _)| *of == length).map(|place| kept.remove(place).1);
    let plan = known.unwrap_or_else(planned);
    if kept.len() == KEPT {
        kept.remove(0);
    }
    kept.push((length, plan.clone()));
    plan
}
