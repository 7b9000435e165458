//! What estimates have to say, in words.

use ident::{Doubt, Termination};

/// A reason to doubt, with what can be done.
pub(super) fn doubt(doubt: &Doubt, parameters: &[String]) -> String {
    match doubt {
        Doubt::NotConverged => {
            "the search stopped before it had converged; the numbers are provisional: try a lower order, or other data"
                .into()
        }
        Doubt::IllConditioned { condition } => format!(
            "the data barely tell the parameters apart (condition number {condition:.1e}); lower the order or excite the system better"
        ),
        Doubt::RowsLeftOut { rows, of } => format!("{rows} of {of} rows were left out, since samples are missing"),
        Doubt::AtBound { parameter } => format!(
            "{} rests on its bound, so its interval means nothing; widen the bound or leave the parameter out",
            parameters.get(*parameter).map_or("a parameter", String::as_str)
        ),
        Doubt::Unstable => "the model is not stable: simulating it runs away".into(),
        Doubt::CovarianceIsLowerBound => {
            "the intervals are the narrowest that any method could reach; the true ones are wider".into()
        }
        other => format!("{other:?}"),
    }
}

/// How a search ended.
pub(super) fn termination(termination: Termination) -> &'static str {
    match termination {
        Termination::Direct => "solved at once",
        Termination::SmallStep => "converged: the steps became negligible",
        Termination::SmallDecrease => "converged: the errors no longer fall",
        Termination::NoDescent => "as good as the arithmetic allows",
        Termination::IterationLimit => "stopped at the limit of iterations",
    }
}
