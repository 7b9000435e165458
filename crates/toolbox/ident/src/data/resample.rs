//! Other sample times, and delays taken out of inputs.

use signal::Signal;
use signal::resample::{
    Interpolation, band_of_held, band_of_straight, fractional_delay, hold, interpolate_at, resample_rational,
};

use super::select::{check_indices, check_range};
use super::{Dataset, Experiment, Intersample};
use crate::IdentError;

impl Dataset {
    /// The data with `up` samples where there were `down`.
    ///
    /// Values go through the low-pass of [`resample_rational`], without a shift in time; to fewer samples it takes off
    /// what lies above the new Nyquist frequency and leaves what lies below 0.8 of it, on inputs and outputs alike: of
    /// inputs that are held or straight between samples, of what they do there. They are then band-limited, and so does
    /// the result say. To a multiple of the samples, held inputs are held and straight ones stay straight; all else is
    /// interpolated band-limited. Interpolated samples bring no information: noise becomes coloured.
    ///
    /// # Errors
    /// [`signal::SignalError::Parameter`] for a zero, or a factor above 10 000; [`IdentError::Missing`]: fill the gaps
    /// or split the data there.
    ///
    /// # Example
    /// ```
    /// let x: Vec<f64> = (0..400).map(|i| (0.05 * i as f64).sin()).collect();
    /// let coarse = ident::Dataset::siso(0.01, &x, &x)?.resample(2, 5)?;
    /// assert!((coarse.sample_time_s() - 0.025).abs() < 1e-15);
    /// assert!((coarse.experiments()[0].output(0)[80] - (0.05 * 200.0_f64).sin()).abs() < 1e-3);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn resample(&self, up: usize, down: usize) -> Result<Self, IdentError> {
        check_range("up", up as f64, 1.0, f64::INFINITY)?;
        check_range("down", down as f64, 1.0, f64::INFINITY)?;
        let shared = greatest_common_divisor(up, down);
        let (up, down) = (up / shared, down / shared);
        if up == down {
            return Ok(self.clone());
        }
        self.refuse_missing()?;
        let mut resampled = Dataset { sample_time_s: self.sample_time_s * down as f64 / up as f64, ..self.clone() };
        if down > 1 {
            resampled.intersample = Intersample::BandLimited;
        }
        let clock = (self.sample_time_s, up, down);
        let way = if down > 1 { Intersample::BandLimited } else { self.intersample };
        for (experiment, original) in resampled.experiments.iter_mut().zip(&self.experiments) {
            let input = |k: usize| match down {
                1 => resample(original.input(k), clock, way),
                _ => resample(&band_of(original.input(k), self.intersample)?, clock, way),
            };
            experiment.inputs = columns(original.inputs.ncols(), input)?;
            let smooth = Intersample::BandLimited;
            experiment.outputs = columns(original.outputs.ncols(), |i| resample(original.output(i), clock, smooth))?;
            if experiment.inputs.ncols() == 0 {
                experiment.inputs = faer::Mat::zeros(experiment.outputs.nrows(), 0);
            }
        }
        Ok(resampled)
    }

    /// One input delayed by a number of samples, `u(t − d)`, so that the delay of a model from it falls by `d`;
    /// negative advances it. Rows where it is not known are cut off.
    ///
    /// A fraction of a sample is interpolated: along straight lines for held and straight inputs (for held ones that is
    /// the mean of the delayed input over each interval, right to first order in the sample time), band-limited for
    /// others.
    ///
    /// # Errors
    /// [`lti::LtiError::Index`]; [`signal::SignalError::Parameter`] for a delay that is not finite;
    /// [`IdentError::Missing`] for a fraction of a sample with samples missing; [`IdentError::TooFewSamples`] where no
    /// row is left of an experiment.
    ///
    /// # Example
    /// ```
    /// let data = ident::Dataset::siso(0.1, &[1.0, 2.0, 3.0, 4.0], &[5.0, 6.0, 7.0, 8.0])?.delay_input(0, 1.0)?;
    /// let e = &data.experiments()[0];
    /// assert_eq!((e.input(0), e.output(0)), (&[1.0, 2.0, 3.0][..], &[6.0, 7.0, 8.0][..]));
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn delay_input(&self, input: usize, samples: f64) -> Result<Self, IdentError> {
        check_indices("input", &[input], self.inputs())?;
        check_range("samples", samples, -f64::MAX, f64::MAX)?;
        if samples.fract() != 0.0 {
            self.channels(&[input], &[0])?.refuse_missing_inputs()?;
        }
        self.map_experiments(|e| self.delayed(e, input, samples))
    }

    fn delayed(&self, e: &Experiment, input: usize, samples: f64) -> Result<Experiment, IdentError> {
        let lost = samples.abs().ceil();
        if lost >= e.len() as f64 {
            return Err(IdentError::TooFewSamples { samples: e.len(), parameters: lost.min(1e18) as usize + 1 });
        }
        let lost = lost as usize;
        let kept = if samples >= 0.0 { lost..e.len() } else { 0..e.len() - lost };
        let shift = samples.trunc() as isize;
        let fraction = samples - samples.trunc();
        let x = if fraction == 0.0 {
            e.input(input).to_vec()
        } else {
            let signal = Signal::new(0.0, 1.0, e.input(input).to_vec())?;
            let method = match self.intersample {
                Intersample::BandLimited => Interpolation::BandLimited,
                _ => Interpolation::Linear,
            };
            fractional_delay(&signal, fraction, method)?.samples
        };
        let mut cut = e.rows(kept.clone(), self.sample_time_s);
        for (i, row) in kept.enumerate() {
            cut.inputs[(i, input)] = x[row.wrapping_add_signed(-shift)];
        }
        Ok(cut)
    }

    fn refuse_missing_inputs(&self) -> Result<(), IdentError> {
        let missing = |e: &Experiment| (0..self.inputs()).find_map(|k| e.input(k).iter().position(|v| v.is_nan()));
        match self.experiments.iter().find_map(missing) {
            Some(index) => Err(IdentError::Missing { what: "the input to be delayed", index }),
            None => Ok(()),
        }
    }
}

/// A matrix column by column; all must be equally long.
fn columns(count: usize, column: impl Fn(usize) -> Result<Vec<f64>, IdentError>) -> Result<faer::Mat<f64>, IdentError> {
    let all: Vec<Vec<f64>> = (0..count).map(column).collect::<Result<_, _>>()?;
    Ok(faer::Mat::from_fn(all.first().map_or(0, Vec::len), count, |i, j| all[j][i]))
}

/// Content of an input below the Nyquist frequency, at the samples, for its behaviour between them.
fn band_of(x: &[f64], intersample: Intersample) -> Result<Vec<f64>, IdentError> {
    if x.is_empty() {
        return Ok(Vec::new());
    }
    let signal = Signal::new(0.0, 1.0, x.to_vec())?;
    Ok(match intersample {
        Intersample::ZeroOrderHold => band_of_held(&signal)?.samples,
        Intersample::FirstOrderHold => band_of_straight(&signal)?.samples,
        Intersample::BandLimited => signal.samples,
    })
}

/// As many samples as lie within the record.
fn resample(x: &[f64], clock: (f64, usize, usize), way: Intersample) -> Result<Vec<f64>, IdentError> {
    let (sample_time_s, up, down) = clock;
    if x.is_empty() {
        return Ok(Vec::new());
    }
    let signal = Signal::new(0.0, sample_time_s, x.to_vec())?;
    let count = (x.len() - 1) * up / down + 1;
    let step_s = sample_time_s * down as f64 / up as f64;
    let times_s = || (0..count).map(|i| i as f64 * step_s).collect::<Vec<f64>>();
    Ok(match way {
        Intersample::ZeroOrderHold => hold(&signal, &times_s())?,
        Intersample::FirstOrderHold => interpolate_at(&signal, &times_s(), Interpolation::Linear)?,
        Intersample::BandLimited => {
            let mut samples = resample_rational(&signal, up, down)?.samples;
            samples.truncate(count);
            samples
        }
    })
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}
