use numerics::random::{Random, Stream};

/// Seeds give the numbers they always gave: recorded simulations and published results depend on them.
#[test]
fn regress_seeds_keep_their_numbers() {
    let mut random = Random::new(7);
    assert_eq!([random.bits(), random.bits()], [0x0e2c_1a00_2aae_913d, 0x2c0f_c8dd_fa4e_9e14]);
    assert_eq!(random.uniform(), 0.717_576_128_358_659_4);
    assert_eq!([random.normal(), random.normal()], [1.028_284_917_676_083_3, -0.182_741_061_903_686_77]);
    let mut random = Random::new(u64::MAX);
    assert_eq!(random.bits(), 0x56cc_f8ce_948e_27b2);
}

#[test]
fn regress_streams_keep_their_numbers() {
    let mut stream = Stream::new(7, 3);
    let uniform = [stream.uniform(), stream.uniform()];
    let normal = [stream.normal(), stream.normal(), stream.normal()];
    assert_eq!(uniform, [0.181_541_863_951_255_38, 0.092_864_375_217_378_23]);
    assert_eq!(normal, [-1.403_233_433_075_779_9, 2.399_557_260_698_516_3, -0.695_835_336_205_335_4]);
}

#[test]
fn stat_normal_numbers_have_their_moments() {
    let (mut random, mut stream) = (Random::new(1), Stream::new(1, 1));
    let count = 200_000;
    for draw in [&mut (|| random.normal()) as &mut dyn FnMut() -> f64, &mut || stream.normal()] {
        let values: Vec<f64> = (0..count).map(|_| draw()).collect();
        let moment = |power: i32| values.iter().map(|v| v.powi(power)).sum::<f64>() / f64::from(count);
        // Four standard deviations of each moment.
        let deviation = |variance: f64| 4.0 * (variance / f64::from(count)).sqrt();
        assert!(moment(1).abs() < deviation(1.0));
        assert!((moment(2) - 1.0).abs() < deviation(2.0));
        assert!((moment(4) - 3.0).abs() < deviation(96.0));
    }
}

#[test]
fn prop_streams_of_one_seed_are_unrelated() {
    let draw = |number| {
        let mut stream = Stream::new(5, number);
        (0..10_000).map(|_| stream.normal()).collect::<Vec<f64>>()
    };
    let correlation = numerics::vector::dot(&draw(1), &draw(2)) / 10_000.0;
    assert!(correlation.abs() < 0.04, "{correlation}");
}

#[test]
fn prop_uniform_numbers_stay_between_their_bounds() {
    let mut stream = Stream::new(2, 0);
    assert!((0..1000).map(|_| stream.between(-3.0, 2.0)).all(|v| (-3.0..2.0).contains(&v)));
    let first = (0..1000).filter(|_| stream.either(1.0, 2.0) == 1.0).count();
    assert!((430..570).contains(&first), "{first}");
}
