//! Formulas written as text, such as `2.5 * X1 ^ 2 + sin(X1)`.

/// A formula of one variable, in the order in which it is computed.
#[derive(Debug, Clone)]
pub(crate) struct Formula {
    steps: Vec<Step>,
}

#[derive(Debug, Clone, Copy)]
enum Step {
    Number(f64),
    Variable,
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Call(fn(f64) -> f64),
}

/// Deeper nesting is no formula that a person wrote.
const DEEPEST: usize = 64;

impl Formula {
    /// `None` where the text is not understood.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut parser = Parser { rest: text, steps: Vec::new(), depth: 0, is_doubled: None };
        parser.sum()?;
        parser.rest.trim_start().is_empty().then_some(Self { steps: parser.steps })
    }

    /// Description of a formula that is not understood.
    pub(crate) fn refused(text: &str) -> String {
        format!("the formula \"{}\"", text.escape_debug())
    }

    pub(crate) fn apply(&self, x: &mut [f64]) {
        let mut stack = Vec::with_capacity(self.steps.len());
        for x in x {
            stack.clear();
            self.steps.iter().for_each(|step| step.take(*x, &mut stack));
            *x = stack.last().copied().unwrap_or(f64::NAN);
        }
    }
}

impl Step {
    fn take(self, x: f64, stack: &mut Vec<f64>) {
        let mut pop = || stack.pop().unwrap_or(f64::NAN);
        let result = match self {
            Self::Number(number) => number,
            Self::Variable => x,
            Self::Negate => -pop(),
            Self::Call(function) => function(pop()),
            Self::Add | Self::Subtract | Self::Multiply | Self::Divide | Self::Power => {
                let (right, left) = (pop(), pop());
                match self {
                    Self::Add => left + right,
                    Self::Subtract => left - right,
                    Self::Multiply => left * right,
                    Self::Divide => left / right,
                    _ => left.powf(right),
                }
            }
        };
        stack.push(result);
    }
}

struct Parser<'a> {
    rest: &'a str,
    steps: Vec<Step>,
    depth: usize,
    /// True if the variable is `X11`: asammdf 8 writes so each `X1` of a formula in MDF 3.
    is_doubled: Option<bool>,
}

impl Parser<'_> {
    /// Takes the sign if it comes next.
    fn next(&mut self, sign: &str) -> bool {
        let rest = self.rest.trim_start();
        let after = rest.strip_prefix(sign);
        self.rest = after.unwrap_or(rest);
        after.is_some()
    }

    fn sum(&mut self) -> Option<()> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        self.product()?;
        loop {
            let step = if self.next("+") {
                Step::Add
            } else if self.next("-") {
                Step::Subtract
            } else {
                break;
            };
            self.product()?;
            self.steps.push(step);
        }
        self.depth -= 1;
        Some(())
    }

    fn product(&mut self) -> Option<()> {
        self.signed()?;
        loop {
            let step = if self.next("*") {
                Step::Multiply
            } else if self.next("/") {
                Step::Divide
            } else {
                return Some(());
            };
            self.signed()?;
            self.steps.push(step);
        }
    }

    fn signed(&mut self) -> Option<()> {
        let mut is_negative = false;
        loop {
            if self.next("-") {
                is_negative = !is_negative;
            } else if !self.next("+") {
                break;
            }
        }
        self.power()?;
        if is_negative {
            self.steps.push(Step::Negate);
        }
        Some(())
    }

    fn power(&mut self) -> Option<()> {
        self.operand()?;
        if self.next("**") || self.next("^") {
            self.depth += 1;
            if self.depth > DEEPEST {
                return None;
            }
            self.signed()?;
            self.depth -= 1;
            self.steps.push(Step::Power);
        }
        Some(())
    }

    fn operand(&mut self) -> Option<()> {
        if self.next("(") {
            self.sum()?;
            return self.next(")").then_some(());
        }
        let rest = self.rest;
        if rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            return self.number();
        }
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        let name = rest[..end].to_ascii_lowercase();
        self.rest = &rest[end..];
        match name.as_str() {
            "x" | "x1" | "x11" => self.variable(name == "x11")?,
            "pi" => self.steps.push(Step::Number(std::f64::consts::PI)),
            _ => return self.call(&name),
        }
        Some(())
    }

    /// The variable, written one way throughout.
    fn variable(&mut self, is_doubled: bool) -> Option<()> {
        self.steps.push(Step::Variable);
        (*self.is_doubled.get_or_insert(is_doubled) == is_doubled).then_some(())
    }

    fn call(&mut self, name: &str) -> Option<()> {
        if !self.next("(") {
            return None;
        }
        self.sum()?;
        if matches!(name, "pow" | "power") {
            if !self.next(",") {
                return None;
            }
            self.sum()?;
            self.steps.push(Step::Power);
        } else {
            self.steps.push(Step::Call(function(name)?));
        }
        self.next(")").then_some(())
    }

    fn number(&mut self) -> Option<()> {
        let text = self.rest.as_bytes();
        let mut end = 0;
        while let Some(&c) = text.get(end) {
            let is_sign_of_exponent = matches!(c, b'+' | b'-') && matches!(text[end - 1], b'e' | b'E');
            let is_exponent = matches!(c, b'e' | b'E') && !text[..end].iter().any(|c| matches!(c, b'e' | b'E'));
            if !(c.is_ascii_digit() || c == b'.' || is_exponent || (end > 0 && is_sign_of_exponent)) {
                break;
            }
            end += 1;
        }
        let number = self.rest[..end].parse().ok()?;
        self.rest = &self.rest[end..];
        self.steps.push(Step::Number(number));
        Some(())
    }
}

fn function(name: &str) -> Option<fn(f64) -> f64> {
    Some(match name {
        "sin" => f64::sin,
        "cos" => f64::cos,
        "tan" => f64::tan,
        "asin" | "arcsin" => f64::asin,
        "acos" | "arccos" => f64::acos,
        "atan" | "arctan" => f64::atan,
        "sinh" => f64::sinh,
        "cosh" => f64::cosh,
        "tanh" => f64::tanh,
        "exp" => f64::exp,
        "ln" | "log" => f64::ln,
        "log10" => f64::log10,
        "log2" => f64::log2,
        "sqrt" => f64::sqrt,
        "abs" | "fabs" => f64::abs,
        "floor" => f64::floor,
        "ceil" => f64::ceil,
        _ => return None,
    })
}
