//! Invariants of numbers and text.

use proptest::prelude::*;
use proptest::sample::select;
use report::wording::number;
use rig::results::{Notation, Quantity, WrittenParameter};

use crate::fixture;

fn parse(text: &str) -> f64 {
    text.replace('−', "-").parse().unwrap_or(f64::NAN)
}

proptest! {
    /// The written value lies within a twentieth of the written uncertainty's unit place of the true one.
    #[test]
    fn prop_value_is_written_to_the_place_of_its_uncertainty(value in -9e4..9e4f64, uncertainty in 1e-3..1e3f64) {
        let text = number::plus_minus(value, uncertainty, "Nm");
        let numbers = text.strip_suffix(" Nm").and_then(|numbers| numbers.split_once(" ± "));
        let (written, spread) = numbers.ok_or_else(|| TestCaseError::fail(text.clone()))?;
        prop_assert!((parse(written) - value).abs() <= 0.0501 * uncertainty.max(parse(spread)), "{text}");
        prop_assert!((parse(spread) / uncertainty - 1.0).abs() <= 0.0501, "{text}");
    }

    #[test]
    fn prop_any_number_can_be_written(value in any::<f64>(), low in any::<f64>(), high in any::<f64>(), unit in select(vec!["s", "Nm", ""])) {
        let parameter = WrittenParameter {
            key: Quantity::Stiffness,
            notation: Notation { unit, ..Quantity::Stiffness.notation() },
            value,
            standard_error: low,
            degrees_of_freedom: high,
            interval: (low, high),
        };
        for text in [
            number::parameter(parameter),
            number::interval(parameter),
            number::plus_minus(value, high, ""),
            number::measure(value, "s"),
            number::duration(value),
            number::share(value),
            number::fit(value),
            number::rpm(value),
        ] {
            prop_assert!(!text.is_empty() && !text.contains("NaN") && !text.contains("inf"), "{text}");
            prop_assert!(!text.contains('-'), "{text}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn prop_any_text_stays_text(text in "[<>&\"'/!\\-a-z\u{0}-\u{1f}\u{202a}-\u{202e}]{0,40}") {
        let page = fixture::html(&fixture::hostile(&format!("~{text}~")));
        let count = |needle: &str| page.matches(needle).count();
        let plain = fixture::html(&fixture::hostile("~~"));
        prop_assert_eq!(count("<"), plain.matches('<').count());
        prop_assert_eq!(count("</script>"), plain.matches("</script>").count());
    }
}
