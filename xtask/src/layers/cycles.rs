//! Arrows between modules, and the circles they make among neighbours.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;
use std::path::Path;

use super::names::Target;
use super::source::Tree;

/// Which module uses items of which, with the places.
pub(super) struct Arrows {
    uses: BTreeMap<(usize, usize), Vec<Place>>,
}

#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    module: usize,
    line: usize,
    path: String,
}

impl Arrows {
    /// The arrows of a crate. Calls of methods make none: whose they are is not written where they are called.
    pub(super) fn of(tree: &Tree) -> Self {
        let mut uses: BTreeMap<(usize, usize), Vec<Place>> = BTreeMap::new();
        for (from, module) in tree.modules.iter().enumerate() {
            for mention in module.mentions.iter().filter(|mention| !module.is_local(&mention.path)) {
                if let Some(Target::Item(to)) = tree.resolve(from, &mention.path)
                    && to != from
                {
                    let place = Place { module: from, line: mention.line, path: mention.path.join("::") };
                    uses.entry((from, to)).or_default().push(place);
                }
            }
        }
        uses.values_mut().for_each(|places| {
            places.sort();
            places.dedup();
        });
        Self { uses }
    }

    /// How many pairs of modules there are of which one uses the other.
    pub(super) fn count(&self) -> usize {
        self.uses.len()
    }
}

/// Among which modules a circle goes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Modules below the same module.
    Siblings,
    /// A module's own items and modules below it.
    ParentAndChildren,
}

/// Modules that use one another in a circle.
pub(super) struct Cycle {
    pub(super) kind: Kind,
    /// All of them that reach one another.
    pub(super) members: Vec<String>,
    /// A shortest way around, each step with its places.
    steps: Vec<Step>,
    /// Every arrow among the members.
    all: Vec<Step>,
}

struct Step {
    from: String,
    to: String,
    /// `file:line path`
    places: Vec<String>,
}

/// How many places of an arrow are listed.
const SHOWN: usize = 4;

/// All circles among the modules below each module, and among these and that module's own items.
pub(super) fn find(tree: &Tree, arrows: &Arrows, root: &Path) -> Vec<Cycle> {
    let mut cycles = Vec::new();
    for parent in (0..tree.modules.len()).filter(|&m| !tree.modules[m].children.is_empty()) {
        for kind in [Kind::Siblings, Kind::ParentAndChildren] {
            let level = Level::of(tree, arrows, parent, kind);
            let circles = level.circles().into_iter();
            let reported = circles.filter(|circle| kind == Kind::Siblings || circle.contains(&parent));
            cycles.extend(reported.map(|circle| level.describe(tree, &circle, root)));
        }
    }
    cycles
}

/// The modules below one module, as nodes of a graph; that module's own items may be one more node.
struct Level {
    kind: Kind,
    arrows: BTreeMap<usize, BTreeMap<usize, Vec<Place>>>,
}

impl Level {
    fn of(tree: &Tree, arrows: &Arrows, parent: usize, kind: Kind) -> Self {
        let node = |module: usize| {
            let mut at = module;
            while at != parent && tree.modules[at].parent != Some(parent) {
                at = tree.modules[at].parent?;
            }
            (at != parent || kind == Kind::ParentAndChildren).then_some(at)
        };
        let mut level: BTreeMap<usize, BTreeMap<usize, Vec<Place>>> = BTreeMap::new();
        for (&(from, to), places) in &arrows.uses {
            if let (Some(from), Some(to)) = (node(from), node(to))
                && from != to
            {
                level.entry(from).or_default().entry(to).or_default().extend(places.iter().cloned());
            }
        }
        Self { kind, arrows: level }
    }

    fn next(&self, node: usize) -> impl Iterator<Item = usize> {
        self.arrows.get(&node).into_iter().flat_map(|to| to.keys().copied())
    }

    /// The shortest way along arrows from `start` back to it.
    fn around(&self, start: usize) -> Option<Vec<usize>> {
        let mut before = BTreeMap::new();
        let mut waiting = VecDeque::from([start]);
        while let Some(node) = waiting.pop_front() {
            for next in self.next(node) {
                if next == start {
                    let mut way = vec![start, node];
                    while way.last() != Some(&start) {
                        way.push(before[&way[way.len() - 1]]);
                    }
                    way.reverse();
                    return Some(way);
                }
                if let std::collections::btree_map::Entry::Vacant(entry) = before.entry(next) {
                    entry.insert(node);
                    waiting.push_back(next);
                }
            }
        }
        None
    }

    fn reached(&self, start: usize) -> BTreeSet<usize> {
        let mut reached = BTreeSet::new();
        let mut waiting = vec![start];
        while let Some(node) = waiting.pop() {
            waiting.extend(self.next(node).filter(|&next| reached.insert(next)));
        }
        reached
    }

    /// Groups of nodes that all reach one another.
    fn circles(&self) -> Vec<BTreeSet<usize>> {
        let reached: BTreeMap<usize, _> = self.arrows.keys().map(|&node| (node, self.reached(node))).collect();
        let mut circles: Vec<BTreeSet<usize>> = Vec::new();
        for (&node, from_node) in reached.iter().filter(|(node, from_node)| from_node.contains(node)) {
            if circles.iter().any(|circle| circle.contains(&node)) {
                continue;
            }
            circles.push(
                from_node
                    .iter()
                    .copied()
                    .filter(|other| reached.get(other).is_some_and(|r| r.contains(&node)))
                    .collect(),
            );
        }
        circles
    }

    fn describe(&self, tree: &Tree, circle: &BTreeSet<usize>, root: &Path) -> Cycle {
        let ways = circle.iter().filter_map(|&node| self.around(node));
        let way = ways.min_by_key(Vec::len).unwrap_or_default();
        let step = |from: usize, to: usize, places: &[Place]| Step {
            from: tree.path(from),
            to: tree.path(to),
            places: places.iter().map(|place| written(tree, place, root)).collect(),
        };
        let inside = |node: &usize| circle.contains(node);
        let all = self.arrows.iter().filter(|(from, _)| inside(from)).flat_map(|(&from, targets)| {
            targets.iter().filter(|(to, _)| inside(to)).map(move |(&to, places)| step(from, to, places))
        });
        Cycle {
            kind: self.kind,
            members: circle.iter().map(|&node| tree.path(node)).collect(),
            steps: way.windows(2).map(|w| step(w[0], w[1], &self.arrows[&w[0]][&w[1]])).collect(),
            all: all.collect(),
        }
    }
}

fn written(tree: &Tree, place: &Place, root: &Path) -> String {
    let file = &tree.modules[place.module].file;
    format!("{}:{} {}", file.strip_prefix(root).unwrap_or(file).display(), place.line, place.path)
}

impl fmt::Display for Cycle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} modules use one another in a circle: {}", self.members.len(), self.members.join(", "))?;
        write!(f, "\n  the shortest way around:")?;
        self.steps.iter().try_for_each(|step| write!(f, "\n{step}"))
    }
}

impl Cycle {
    /// With every arrow among the members, those with the fewest places first.
    pub(super) fn in_full(&self) -> String {
        let mut steps: Vec<&Step> = self.all.iter().collect();
        steps.sort_by_key(|step| step.places.len());
        let all: Vec<String> = steps.iter().map(|step| step.to_string()).collect();
        format!("{self}\n  all arrows:\n{}", all.join("\n"))
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "    {} -> {}", self.from, self.to)?;
        self.places.iter().take(SHOWN).try_for_each(|place| write!(f, "\n      {place}"))?;
        match self.places.len().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n      and {more} more"),
        }
    }
}
