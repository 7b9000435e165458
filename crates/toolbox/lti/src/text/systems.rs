//! How each kind of system is written.

use faer::MatRef;

use super::layout::{Table, indented, matrices, parameter_list};
use super::number::number;
use super::polynomial::{Fraction, Polynomial};
use super::{Errors, Written, clock, display_as_written};
use crate::{
    Complex64, Innovations, PolynomialEquation, PolynomialModel, ProcessModel, StateSpace, TransferFunction,
    ZeroPoleGain,
};

display_as_written!(TransferFunction, ZeroPoleGain, StateSpace, Innovations, ProcessModel, PolynomialModel);

impl Written for TransferFunction {
    /// Parameters are the coefficients of the numerator, those of the denominator behind its first, and the delay.
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        let (letter, mut errors) = (variable(self.sample_time_s()), Errors::new(standard_errors));
        let degree = |p: &[f64]| p.len() as i32 - 1;
        let numerator = Polynomial::new(letter).with_coefficients(
            degree(self.num()),
            -1,
            self.num(),
            errors.take(self.num().len()),
        );
        let degree = degree(self.den());
        let (lead, rest) = self.den().split_at(self.den().len().min(1));
        let denominator = Polynomial::new(letter)
            .with_constant(degree, lead.first().copied().unwrap_or(0.0))
            .with_coefficients(degree - 1, -1, rest, errors.take(rest.len()));
        let fraction = Fraction {
            numerator: numerator.on_one_line(),
            denominator: denominator.on_one_line(),
            factor: delay_factor(self.delay_s(), self.sample_time_s(), errors.take(1)),
        };
        let kind = format!("Transfer function in {}", clock(self.sample_time_s()));
        format!("{kind}\n{}", indented(&fraction.equation(&format!("G({letter})"))))
    }
}

impl Written for ZeroPoleGain {
    fn written(&self, _: Option<&[f64]>) -> String {
        let letter = variable(self.sample_time_s());
        let gain = number(self.gain());
        let numerator = match factors(letter, self.zeros()) {
            zeros if zeros.is_empty() => gain,
            zeros => format!("{gain} {zeros}"),
        };
        let denominator = match factors(letter, self.poles()) {
            poles if poles.is_empty() => "1".to_owned(),
            poles => poles,
        };
        let factor = delay_factor(self.delay_s(), self.sample_time_s(), None);
        let fraction = Fraction { numerator, denominator, factor };
        let kind = format!("Zeros, poles and gain in {}", clock(self.sample_time_s()));
        format!("{kind}\n{}", indented(&fraction.equation(&format!("G({letter})"))))
    }
}

impl Written for StateSpace {
    fn written(&self, _: Option<&[f64]>) -> String {
        state_space(self, None)
    }
}

impl Written for Innovations {
    fn written(&self, _: Option<&[f64]>) -> String {
        state_space(self.system(), Some(self.k()))
    }
}

impl Written for ProcessModel {
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        let list = parameter_list(&self.parameter_names(), &self.parameters(), standard_errors);
        format!("Process model in continuous time\n{}\n\n{}", indented(&self.equation("G(s)")), indented(&list))
    }
}

impl ProcessModel {
    /// The structure as a ratio of the parameters' names, such as `K over 1 + Tp1 s`.
    pub(crate) fn equation(&self, head: &str) -> String {
        let mut numerator = "K".to_owned();
        if self.zero_s().is_some() {
            numerator += " (1 + Tz s)";
        }
        let pair = self.pair().map(|_| "(1 + 2 zeta Tw s + (Tw s)²)".to_owned());
        let first = 1 + 2 * usize::from(pair.is_some());
        let lags = (first..first + self.lags_s().len()).map(|k| format!("(1 + Tp{k} s)"));
        let integrator = self.integrates().then(|| "s".to_owned());
        let denominator: Vec<String> = integrator.into_iter().chain(pair).chain(lags).collect();
        let denominator = if denominator.is_empty() { "1".to_owned() } else { denominator.join(" ") };
        let factor = if self.delay_s().is_some() { "exp(−Td s)".to_owned() } else { String::new() };
        Fraction { numerator, denominator, factor }.equation(head)
    }
}

impl Written for PolynomialModel {
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        let mut errors = Errors::new(standard_errors);
        let kind = format!("{} in {}", Letters::of(self).family(self.inputs()), clock(Some(self.sample_time_s())));
        let outputs = self.outputs();
        let parts = self.equations().iter().enumerate().map(|(i, equation)| {
            let head = Naming { output: i, outputs, inputs: self.inputs() };
            let lines =
                [vec![head.equation(equation), String::new()], head.polynomials(equation, &mut errors)].concat();
            indented(&lines.join("\n"))
        });
        format!("{kind}\n{}", parts.collect::<Vec<_>>().join("\n\n"))
    }
}

/// Which polynomials a model has.
struct Letters {
    a: bool,
    c: bool,
    d: bool,
    f: bool,
}

impl Letters {
    fn of(model: &PolynomialModel) -> Self {
        let any = |has: fn(&PolynomialEquation) -> bool| model.equations().iter().any(has);
        Letters {
            a: any(|e| e.a.iter().any(|p| !p.is_empty())),
            c: any(|e| !e.c.is_empty()),
            d: any(|e| !e.d.is_empty()),
            f: any(|e| e.f.iter().any(|p| !p.is_empty())),
        }
    }

    /// The name of the family, Ljung 1999, table 4.1.
    fn family(&self, inputs: usize) -> &'static str {
        let Letters { a, c, d, f } = *self;
        match (a, c, d, f) {
            (true, false, false, false) if inputs == 0 => "AR model",
            (true, true, false, false) if inputs == 0 => "ARMA model",
            (false, true, false, false) if inputs == 0 => "MA model",
            (true, false, false, false) => "ARX model",
            (true, true, false, false) => "ARMAX model",
            (true, false, true, false) => "ARARX model",
            (true, true, true, false) => "ARARMAX model",
            (false, false, false, false) => "FIR model",
            (false, false, false, true) => "Output-error model",
            (false, _, _, true) => "Box–Jenkins model",
            _ => "Polynomial model",
        }
    }
}

/// How the polynomials and signals of one equation are called.
struct Naming {
    output: usize,
    outputs: usize,
    inputs: usize,
}

impl Naming {
    /// `A(q) y(t) = B(q) u(t) + e(t)`.
    fn equation(&self, equation: &PolynomialEquation) -> String {
        let several = self.outputs > 1;
        let numbered = |letter: &str, k: usize, many: bool| {
            if many { format!("{letter}{}(t)", k + 1) } else { format!("{letter}(t)") }
        };
        let with = |polynomial: String, signal: String| format!("{polynomial} {signal}");
        let own = |j: usize, p: &[f64]| !p.is_empty() || j == self.output;
        let left = equation.a.iter().enumerate().filter(|(j, p)| own(*j, p)).map(|(j, p)| {
            let signal = numbered("y", j, several);
            if p.is_empty() { signal } else { with(self.of_output('A', j), signal) }
        });
        let driven = equation.b.iter().enumerate().filter(|(_, p)| !p.is_empty()).map(|(k, _)| {
            let b = self.of_input('B', k);
            let ratio = if equation.f[k].is_empty() { b } else { format!("{b}/{}", self.of_input('F', k)) };
            with(ratio, numbered("u", k, self.inputs > 1))
        });
        let e = numbered("e", self.output, several);
        let noise = match (equation.c.is_empty(), equation.d.is_empty()) {
            (true, true) => e,
            (false, true) => with(self.of_noise('C'), e),
            (true, false) => with(format!("1/{}", self.of_noise('D')), e),
            (false, false) => with(format!("{}/{}", self.of_noise('C'), self.of_noise('D')), e),
        };
        let left: Vec<String> = left.collect();
        let right: Vec<String> = driven.chain([noise]).collect();
        format!("{} = {}", left.join(" + "), right.join(" + "))
    }

    /// Every polynomial with its coefficients, in the order in which these are parameters.
    fn polynomials(&self, equation: &PolynomialEquation, errors: &mut Errors<'_>) -> Vec<String> {
        let mut lines = Vec::new();
        let mut push = |name: String, leading: Option<f64>, first: usize, values: &[f64]| {
            let own = errors.take(values.len());
            if values.is_empty() {
                return;
            }
            let start = Polynomial::new("q");
            let start = leading.map_or(start.clone(), |one| start.with_constant(0, one));
            lines.push(start.with_coefficients(-(first as i32), -1, values, own).equation(&name));
        };
        for (j, a) in equation.a.iter().enumerate() {
            push(self.of_output('A', j), (j == self.output).then_some(1.0), 1, a);
        }
        for (k, b) in equation.b.iter().enumerate() {
            push(self.of_input('B', k), None, equation.nk[k], b);
        }
        push(self.of_noise('C'), Some(1.0), 1, &equation.c);
        push(self.of_noise('D'), Some(1.0), 1, &equation.d);
        for (k, f) in equation.f.iter().enumerate() {
            push(self.of_input('F', k), Some(1.0), 1, f);
        }
        lines
    }

    fn of_output(&self, letter: char, j: usize) -> String {
        if self.outputs > 1 { format!("{letter}{}{}(q)", self.output + 1, j + 1) } else { format!("{letter}(q)") }
    }

    fn of_input(&self, letter: char, k: usize) -> String {
        match (self.outputs > 1, self.inputs > 1) {
            (true, _) => format!("{letter}{}{}(q)", self.output + 1, k + 1),
            (false, true) => format!("{letter}{}(q)", k + 1),
            (false, false) => format!("{letter}(q)"),
        }
    }

    fn of_noise(&self, letter: char) -> String {
        if self.outputs > 1 { format!("{letter}{}(q)", self.output + 1) } else { format!("{letter}(q)") }
    }
}

/// Equations and matrices of a system, with its noise gain where it has one.
fn state_space(system: &StateSpace, noise: Option<MatRef<'_, f64>>) -> String {
    let noise = noise.filter(|k| k.norm_max() > 0.0);
    let state = if system.sample_time_s().is_some() { "x(t+T)" } else { "dx/dt" };
    let arguments = if system.sample_time_s().is_some() { "(t)" } else { "" };
    let terms = |pairs: [(&str, &str, bool); 3]| {
        let there = pairs.into_iter().filter(|(_, _, there)| *there);
        there.map(|(matrix, signal, _)| format!("{matrix}{signal}{arguments}")).collect::<Vec<_>>().join(" + ")
    };
    let feedthrough = system.d().norm_max() > 0.0;
    let driven = system.inputs() > 0;
    let first = terms([("A ", "x", true), ("B ", "u", driven), ("K ", "e", noise.is_some())]);
    let second = terms([("C ", "x", true), ("D ", "u", driven && feedthrough), ("", "e", noise.is_some())]);
    let head = format!("State-space model of order {} in {}", system.states(), clock(system.sample_time_s()));
    let output = format!("{:>width$}", format!("y{arguments}"), width = state.len());
    let equations = format!("{state} = {first}\n{output} = {second}");
    let mut tables = vec![
        Table { name: "A", rows: 'x', columns: 'x', values: system.a() },
        Table { name: "B", rows: 'x', columns: 'u', values: system.b() },
        Table { name: "C", rows: 'y', columns: 'x', values: system.c() },
    ];
    if feedthrough {
        tables.push(Table { name: "D", rows: 'y', columns: 'u', values: system.d() });
    }
    tables.extend(noise.map(|values| Table { name: "K", rows: 'x', columns: 'e', values }));
    format!("{head}\n{}\n\n{}", indented(&equations), indented(&matrices(&tables)))
}

/// Roots as factors: `(s + 2) (s² + 0.4 s + 4)`, complex pairs together.
fn factors(letter: &str, roots: &[Complex64]) -> String {
    let factor = |root: &Complex64| {
        let coefficients = match root.im {
            0.0 => vec![1.0, -root.re],
            im if im > 0.0 => vec![1.0, -2.0 * root.re, root.norm_sqr()],
            _ => return None,
        };
        let (lead, rest) = coefficients.split_at(1);
        let degree = rest.len() as i32;
        let polynomial =
            Polynomial::new(letter).with_constant(degree, lead[0]).with_coefficients(degree - 1, -1, rest, None);
        Some(if *root == Complex64::ZERO { letter.to_owned() } else { format!("({})", polynomial.on_one_line()) })
    };
    roots.iter().filter_map(factor).collect::<Vec<_>>().join(" ")
}

/// The variable of a transfer function.
fn variable(sample_time_s: Option<f64>) -> &'static str {
    if sample_time_s.is_some() { "z" } else { "s" }
}

/// A delay as a factor of a transfer function; nothing without one.
fn delay_factor(delay_s: f64, sample_time_s: Option<f64>, error: Option<&[f64]>) -> String {
    let error = error.and_then(|e| e.first()).filter(|e| **e > 0.0);
    if delay_s == 0.0 && error.is_none() {
        return String::new();
    }
    match (sample_time_s, error) {
        (Some(sample_time_s), _) => format!("z^(−{})", number(delay_s / sample_time_s)),
        (None, None) => format!("exp(−{} s)", number(delay_s)),
        (None, Some(error)) => {
            let (value, error) = super::number::digits_of_both(delay_s, *error);
            format!("exp(−{value} (± {}) s)", error.unwrap_or_default())
        }
    }
}
