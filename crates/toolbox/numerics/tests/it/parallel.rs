use std::sync::{Arc, Mutex};

use numerics::parallel::{current_num_threads, join, map, map_as_step, reduce};
use numerics::random::Random;
use numerics::vector::sum_of_squares;
use work::{Context, State};

const THREADS: [usize; 4] = [1, 2, 3, 8];

/// The result of some work on so many threads.
fn with_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    Context::new().with_threads(threads).run(work).unwrap()
}

/// The result of some work on each number of threads, which has to be the same bit for bit.
fn on_any_number_of_threads<R: Send + PartialEq + std::fmt::Debug>(work: impl Fn() -> R + Sync) -> R {
    let first = with_threads(1, &work);
    THREADS.iter().for_each(|threads| assert_eq!(with_threads(*threads, &work), first));
    first
}

#[test]
fn exact_results_keep_the_order_of_their_tasks() {
    let tasks: Vec<usize> = (0..1000).collect();
    let found = on_any_number_of_threads(|| map(&tasks, |task| task * task));
    assert_eq!(found, (0..1000).map(|task| task * task).collect::<Vec<_>>());
    assert!(map(&[] as &[usize], |task| *task).is_empty());
}

#[test]
fn prop_rounding_does_not_depend_on_the_threads() {
    let mut random = Random::new(4);
    let values: Vec<f64> =
        (0..100_003).map(|_| random.normal() * 10f64.powi((random.uniform() * 12.0) as i32)).collect();
    let sum = || reduce(values.len(), 1000, |range| sum_of_squares(&values[range]), |a, b| a + b).map(f64::to_bits);
    let found = f64::from_bits(on_any_number_of_threads(sum).unwrap());
    assert!((found / sum_of_squares(&values) - 1.0).abs() < 1e-12);
    assert_eq!(reduce(0, 10, |range| range.len(), |a, b| a + b), None);
}

#[test]
fn exact_both_sides_of_a_join_are_done() {
    assert_eq!(on_any_number_of_threads(|| join(|| 1, || join(|| 2, || 3))), (1, (2, 3)));
}

#[test]
fn exact_every_task_is_reported() {
    let heard = Arc::new(Mutex::new(Vec::new()));
    let into = Arc::clone(&heard);
    let context = Context::new().with_listener(move |one| into.lock().unwrap().push((one.state, one.done, one.total)));
    assert_eq!(map_as_step(&context, "adding", &[2_u8; 50], |task| task + 1), [3; 50]);
    let heard = heard.lock().unwrap();
    let advanced = heard.iter().filter(|(state, _, total)| *state == State::Advanced && *total == 50).count();
    assert_eq!((heard[0], advanced, heard[51]), ((State::Begun, 0, 50), 50, (State::Ended, 50, 50)));
}

#[test]
fn exact_work_gets_the_threads_that_were_asked_for() {
    THREADS.iter().for_each(|threads| assert_eq!(with_threads(*threads, current_num_threads), *threads));
}

#[test]
#[should_panic(expected = "of a task")]
fn regress_a_panic_reaches_the_caller() {
    map(&[1, 2, 3], |task| assert_ne!(*task, 2, "of a task"));
}
