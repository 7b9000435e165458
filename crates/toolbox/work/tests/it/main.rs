//! Progress, cancellation and threads of long work.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use work::{Cancelled, Context, Progress, State, Tree, checked, checkpoint};

/// A context, and what its listener heard.
fn heard() -> (Context, Arc<Mutex<Vec<Progress>>>) {
    let all = Arc::new(Mutex::new(Vec::new()));
    let into = Arc::clone(&all);
    (Context::new().with_threads(2).with_listener(move |one| into.lock().unwrap().push(one.clone())), all)
}

#[test]
fn exact_steps_are_a_tree_whose_ends_count_as_parts() {
    let (context, heard) = heard();
    context
        .run(|| {
            let study = context.step("study", 2);
            study.step("reading", 3).advance(3);
            drop(study.step("estimating", 0));
        })
        .unwrap();
    let heard = heard.lock().unwrap();
    let told: Vec<_> =
        heard.iter().map(|one| (one.what.as_str(), one.parent, one.done, one.total, one.state)).collect();
    use State::{Advanced, Begun, Ended};
    let expected = [
        ("study", None, 0, 2, Begun),
        ("reading", Some(1), 0, 3, Begun),
        ("reading", Some(1), 3, 3, Advanced),
        ("reading", Some(1), 3, 3, Ended),
        ("estimating", Some(1), 0, 0, Begun),
        ("estimating", Some(1), 0, 0, Ended),
        ("study", None, 2, 2, Ended),
    ];
    assert_eq!(told, expected);
    let mut tree = Tree::default();
    let fractions: Vec<f64> = heard.iter().map(|one| (tree.hear(one), tree.fraction()).1).collect();
    assert_eq!(fractions, [0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0]);
}

#[test]
fn exact_cancelled_work_ends_on_all_threads_and_abandons_its_steps() {
    let (context, heard) = heard();
    let cancel = context.cancel();
    let begun = AtomicUsize::new(0);
    let since = Instant::now();
    let outcome = context.run(|| {
        let _step = context.step("for ever", 0);
        (0..2).into_par_iter().for_each(|_| {
            if begun.fetch_add(1, Ordering::Relaxed) == 1 {
                cancel.cancel();
            }
            loop {
                checkpoint();
                std::thread::sleep(Duration::from_micros(10));
            }
        });
    });
    assert_eq!(outcome, Err(Cancelled));
    assert!(since.elapsed() < Duration::from_secs(10));
    let states: Vec<State> = heard.lock().unwrap().iter().map(|one| one.state).collect();
    assert_eq!(states, [State::Begun, State::Abandoned]);
    assert_eq!(context.run(|| 1), Err(Cancelled), "what is cancelled stays so");
}

#[test]
fn exact_contexts_do_not_know_of_each_other() {
    let [one, two] = [1, 2].map(|threads| Context::new().with_threads(threads));
    one.cancel().cancel();
    let threads = two.run(|| {
        checkpoint();
        rayon::current_num_threads()
    });
    assert_eq!(threads, Ok(2));
    // One within the other: the inner one ends, the outer one goes on.
    let within = two.run(|| {
        let inner = one.run(|| 1);
        checkpoint();
        inner
    });
    assert_eq!(within, Ok(Err(Cancelled)));
    checkpoint();
}

#[test]
fn exact_a_fault_of_the_work_is_no_cancellation() {
    let caught = std::panic::catch_unwind(|| Context::new().run(|| std::panic::resume_unwind(Box::new("a fault"))));
    let fault = caught.map(|_: Result<(), _>| ()).unwrap_err();
    assert_eq!(fault.downcast_ref::<&str>(), Some(&"a fault"));
}

#[test]
fn exact_a_guard_lets_a_cancellation_pass_and_ends_a_panic() {
    assert_eq!(work::guarded(|| 1), Some(1));
    assert_eq!(work::guarded(|| -> u8 { std::panic::resume_unwind(Box::new("a fault")) }), None);
    let context = Context::new();
    let cancel = context.cancel();
    let outcome = context.run(|| {
        cancel.cancel();
        work::guarded(checkpoint)
    });
    assert_eq!(outcome, Err(Cancelled));
}

#[test]
fn exact_a_checked_loop_ends_within_256_rounds_and_changes_nothing_of_its_items() {
    let context = Context::new();
    let (cancel, mut rounds) = (context.cancel(), 0);
    let ended = context.run(|| {
        checked(0..1_000_000).for_each(|k| {
            rounds += 1;
            if k == 1000 {
                cancel.cancel();
            }
        });
    });
    assert_eq!(ended, Err(Cancelled));
    assert!((1001..=1257).contains(&rounds), "{rounds} rounds");
    let all: Vec<usize> = checked(0..1000).collect();
    assert!(all.into_iter().eq(0..1000) && checked(0..1000).size_hint() == (1000, Some(1000)));
}
