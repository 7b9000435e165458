//! Poles and zeros.

use std::f64::consts::TAU;

use ident::uncertainty::{Dynamics, UncertainMode, UncertainRoot};
use ident::{IdentError, ModelDocument};
use lti::{Complex64, LtiError};
use page::decimal::{digits, with_range};
use page::{Align, Block, Blocks, Page, Table};

use super::curves::interval_heading;
use super::facts::{ModelRootsFacts, RegionFacts, RootFacts, RootsFacts};
use super::model::{Model, channel_name, channels};
use super::plane;
use super::roots::Roots;
use crate::blocks::{heading, line};

/// Roots nearer to each other than this part of their size are the same, computed twice.
const SAME: f64 = 1e-9;

/// Poles and zeros of several models.
pub struct Poles {
    models: Vec<Model>,
    roots: Vec<Roots>,
    level: f64,
}

/// The poles and zeros of models, with intervals of this confidence.
///
/// # Errors
/// Where they cannot be computed.
pub fn poles(models: Vec<Model>, level: f64) -> Result<Poles, IdentError> {
    let mut roots = Vec::new();
    for (number, model) in models.iter().enumerate() {
        roots.extend(roots_of(model, number)?);
    }
    Ok(Poles { models, roots, level })
}

impl Poles {
    /// The roots in tables, and in the complex plane.
    pub fn page(&self) -> Page {
        let mut all = Blocks::default();
        for (number, model) in self.models.iter().enumerate() {
            let clock = match model.sample_time_s() {
                Some(t) => format!("roots in z, sample time {} s", digits(t, 6)),
                None => "roots in s, in rad/s".to_owned(),
            };
            all.push(heading(format!("{}: {clock}", model.title())));
            all.push(tables(model, self.of(number), self.level));
        }
        let figures = plane::figures(&self.roots, &self.models, self.level);
        all.push(figures.into_iter().map(Block::figure).collect::<Blocks>());
        Page::new("Poles and zeros", all.into_vec())
    }

    /// The roots in numbers.
    pub fn facts(&self) -> Vec<ModelRootsFacts> {
        let of = |(number, model)| model_facts(model, self.of(number), self.level);
        self.models.iter().enumerate().map(of).collect()
    }

    /// Outlines of the regions of the roots that have one.
    pub fn regions(&self) -> Vec<RegionFacts> {
        let of_set = |set: &Roots| {
            let outlines = set.roots.iter().filter_map(|root| plane::region(root, self.level));
            let facts = |outline: Vec<Complex64>| RegionFacts {
                is_pole: set.is_pole,
                channels: set.channels.clone(),
                outline: outline.iter().map(|point| (point.re, point.im)).collect(),
            };
            outlines.map(facts).collect::<Vec<_>>()
        };
        self.roots.iter().flat_map(of_set).collect()
    }

    fn of(&self, model: usize) -> impl Iterator<Item = &Roots> {
        self.roots.iter().filter(move |roots| roots.model == model)
    }
}

/// Tables of the poles and zeros of one model.
pub(crate) fn roots_of_model(document: &ModelDocument, level: f64) -> Result<Blocks, IdentError> {
    let of_noise = if document.inputs.is_empty() { document.of_noise()? } else { None };
    let model = Model::new(String::new(), of_noise.unwrap_or_else(|| document.clone()))?;
    Ok(tables(&model, roots_of(&model, 0)?.iter(), level))
}

/// The poles, once where all ways have the same, and the zeros of each way.
fn roots_of(model: &Model, number: usize) -> Result<Vec<Roots>, IdentError> {
    let mut poles: Vec<Roots> = Vec::new();
    let mut zeros: Vec<Roots> = Vec::new();
    for (output, input) in channels(model) {
        let (own_poles, own_zeros) = roots(model, output, input)?;
        for (all, is_pole, roots) in [(&mut poles, true, own_poles), (&mut zeros, false, own_zeros)] {
            let name = channel_name(model, output, input);
            match all.iter_mut().find(|known| is_pole && are_same(&known.roots, &roots)) {
                Some(known) => known.channels.push(name),
                None => all.push(Roots { model: number, is_pole, channels: vec![name], roots }),
            }
        }
    }
    for list in [&mut poles, &mut zeros] {
        if let [only] = list.as_mut_slice() {
            only.channels.clear();
        }
    }
    poles.append(&mut zeros);
    Ok(poles)
}

fn are_same(one: &[UncertainRoot], other: &[UncertainRoot]) -> bool {
    let pairs = || one.iter().zip(other);
    one.len() == other.len() && pairs().all(|(a, b)| (a.value - b.value).norm() <= SAME * a.value.norm())
}

/// Poles and zeros of a way; without an estimate they carry no uncertainty.
fn roots(model: &Model, output: usize, input: usize) -> Result<(Vec<UncertainRoot>, Vec<UncertainRoot>), IdentError> {
    let without_effect =
        |error: &IdentError| matches!(error, IdentError::Lti(LtiError::ZeroPolynomial { .. } | LtiError::ZeroSystem));
    if let Some(fit) = &model.fit {
        let zeros = match fit.zeros(output, input) {
            Err(error) if without_effect(&error) => Vec::new(),
            other => other?,
        };
        return Ok((fit.poles(output, input)?, zeros));
    }
    let certain = |value: &Complex64| UncertainRoot {
        value: *value,
        covariance: [[0.0; 2]; 2],
        near_multiple: false,
        degrees_of_freedom: f64::INFINITY,
    };
    let system = model.document.model.system()?;
    let zpk = system.to_zero_pole_gain(output, input)?;
    let poles = lti::settled(zpk.poles(), system.sample_time_s());
    Ok((poles.iter().map(|(value, _)| certain(value)).collect(), zpk.zeros().iter().map(certain).collect()))
}

/// Tables of the roots; the two of a pair share a row.
fn tables<'a>(model: &Model, roots: impl Iterator<Item = &'a Roots>, level: f64) -> Blocks {
    let mut all = Blocks::default();
    for set in roots {
        let kind = if set.is_pole { "poles" } else { "zeros" };
        if !set.channels.is_empty() {
            all.push(line(format!("{kind} of {}", set.channels.join(", "))));
        }
        all.push(if set.roots.is_empty() {
            line(format!("no {kind}"))
        } else {
            Block::Table(table(model, set, level))
        });
    }
    if model.fit.is_some() {
        all.push(line(format!("(in brackets: {})", interval_heading(level))));
    }
    all
}

fn table(model: &Model, set: &Roots, level: f64) -> Table {
    let mut table = Table::new(&[
        (if set.is_pole { "poles" } else { "zeros" }, Align::Left),
        ("natural frequency", Align::Left),
        ("damping", Align::Left),
        ("time constant", Align::Left),
    ]);
    for root in one_of_each_pair(&set.roots) {
        table.row(row(root, &root.mode(model.sample_time_s()), level));
        let rest = if model.sample_time_s().is_some() { Complex64::ONE } else { Complex64::ZERO };
        if set.is_pole && root.value == rest {
            table.note("an integrator: at rest within rounding");
        }
        if root.near_multiple {
            table.note("no intervals: with its uncertainty it reaches another root");
        }
    }
    table
}

fn one_of_each_pair(roots: &[UncertainRoot]) -> Vec<&UncertainRoot> {
    let mut shown: Vec<&UncertainRoot> = roots.iter().filter(|root| root.value.im >= 0.0).collect();
    shown.sort_by(|a, b| b.value.norm().total_cmp(&a.value.norm()));
    shown
}

fn row(root: &UncertainRoot, mode: &UncertainMode, level: f64) -> [page::Cell; 4] {
    let value = match root.value.im {
        0.0 => digits(root.value.re, 5),
        im => format!("{} ± {}i", digits(root.value.re, 5), digits(im, 5)),
    };
    let hertz = |value: f64| value / TAU;
    let frequency = mode.natural_frequency_rad_s(level).map(|(low, high)| (hertz(low), hertz(high)));
    let time_s = mode.mode.time_constant_s();
    let time = if time_s.is_finite() && time_s != 0.0 {
        with_range(time_s, "s", mode.time_constant_s(level))
    } else {
        "–".to_owned()
    };
    let omega = mode.mode.natural_frequency_rad_s;
    let frequency = if omega.is_finite() { with_range(hertz(omega), "Hz", frequency) } else { "–".to_owned() };
    [value.into(), frequency.into(), with_range(mode.mode.damping, "", mode.damping(level)).into(), time.into()]
}

fn model_facts<'a>(model: &Model, roots: impl Iterator<Item = &'a Roots>, level: f64) -> ModelRootsFacts {
    let all: Vec<String> = channels(model).map(|(output, input)| channel_name(model, output, input)).collect();
    let (mut poles, mut zeros) = (Vec::new(), Vec::new());
    for set in roots {
        let facts = RootsFacts {
            channels: if set.channels.is_empty() { all.clone() } else { set.channels.clone() },
            roots: set.roots.iter().map(|root| root_facts(root, model.sample_time_s(), level)).collect(),
        };
        if set.is_pole { poles.push(facts) } else { zeros.push(facts) }
    }
    ModelRootsFacts { model: model.name.clone(), sample_time_s: model.sample_time_s(), level, poles, zeros }
}

fn root_facts(root: &UncertainRoot, sample_time_s: Option<f64>, level: f64) -> RootFacts {
    let mode = root.mode(sample_time_s);
    let frequency = mode.natural_frequency_rad_s(level);
    RootFacts {
        re: root.value.re,
        im: root.value.im,
        covariance: root.covariance,
        near_multiple: root.near_multiple,
        natural_frequency_hz: mode.mode.natural_frequency_rad_s / TAU,
        natural_frequency_interval_hz: frequency.map(|(low, high)| (low / TAU, high / TAU)),
        damping: mode.mode.damping,
        damping_interval: mode.damping(level),
        time_constant_s: mode.mode.time_constant_s(),
        time_constant_interval_s: mode.time_constant_s(level),
    }
}
