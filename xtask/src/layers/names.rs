//! Meaning of a path: the module that defines it, found through imports and re-exports.

use std::collections::HashSet;

use super::source::Tree;

/// Target of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Module(usize),
    /// An item, by the module that defines it.
    Item(usize),
}

/// Names under way, so that imports that go in a circle end.
type UnderWay = HashSet<(usize, String)>;

impl Tree {
    /// Target of `path`, written in module `from`; `None` for what is not of this crate.
    pub(super) fn resolve(&self, from: usize, path: &[String]) -> Option<Target> {
        self.walk(from, path, &mut UnderWay::new())
    }

    fn walk(&self, from: usize, path: &[String], under_way: &mut UnderWay) -> Option<Target> {
        let mut at = from;
        let mut rest = path;
        while let Some((first, others)) = rest.split_first() {
            match first.as_str() {
                "crate" => at = 0,
                "self" => {}
                "super" => at = self.modules[at].parent?,
                _ => break,
            }
            rest = others;
        }
        let anchored = rest.len() < path.len();
        for (i, name) in rest.iter().enumerate() {
            let last = i + 1 == rest.len();
            let found = self.look_up(at, name, last, under_way);
            let found = if i == 0 && !anchored && last { found.or_else(|| self.macro_above(at, name)) } else { found };
            match found? {
                Target::Module(module) => at = module,
                // What follows are variants or associated items.
                item => return Some(item),
            }
        }
        Some(Target::Module(at))
    }

    /// A name in the scope of a module. Before the end of a path it is rather a module, at the end rather an item.
    fn look_up(&self, module: usize, name: &str, last: bool, under_way: &mut UnderWay) -> Option<Target> {
        let here = &self.modules[module];
        let child = || here.children.iter().copied().find(|&c| self.modules[c].name == name).map(Target::Module);
        let item = || here.defined.contains(name).then_some(Target::Item(module));
        let own = if last { item().or_else(child) } else { child().or_else(item) };
        if own.is_some() {
            return own;
        }
        let key = (module, name.to_owned());
        if !under_way.insert(key.clone()) {
            return None;
        }
        let bound = here.bindings.iter().filter(|(bound, _)| bound == name);
        let found = bound.filter_map(|(_, path)| self.walk(module, path, under_way)).reduce(|best, next| {
            let better = matches!((best, last), (Target::Module(_), true) | (Target::Item(_), false));
            if better { next } else { best }
        });
        let found = found.or_else(|| self.through_globs(module, name, last, under_way));
        under_way.remove(&key);
        found
    }

    fn through_globs(&self, module: usize, name: &str, last: bool, under_way: &mut UnderWay) -> Option<Target> {
        self.modules[module].globs.iter().find_map(|path| match self.walk(module, path, under_way)? {
            Target::Module(source) if source != module => self.look_up(source, name, last, under_way),
            _ => None,
        })
    }

    /// A macro by rules holds in the modules below the one that defines it.
    fn macro_above(&self, module: usize, name: &str) -> Option<Target> {
        let above = self.modules[module].parent?;
        if self.modules[above].macros.contains(name) {
            return Some(Target::Item(above));
        }
        self.macro_above(above, name)
    }
}
