//! The modules of a crate as its files write them: what each one defines, imports and names.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::spanned::Spanned;
use syn::visit::Visit;
use syn::{Attribute, Item, UseTree};

/// The modules of one crate; the first is its root.
pub(super) struct Tree {
    pub(super) modules: Vec<Module>,
}

/// One module without those below it.
#[derive(Default)]
pub(super) struct Module {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    pub(super) children: Vec<usize>,
    pub(super) file: PathBuf,
    /// Names of its items: types, functions, constants, traits, macros.
    pub(super) defined: HashSet<String>,
    /// Those of them that are macros by rules, which hold in the modules below too.
    pub(super) macros: HashSet<String>,
    /// Names it imports, under the name that holds here.
    pub(super) bindings: Vec<(String, Vec<String>)>,
    /// Paths of which it imports everything.
    pub(super) globs: Vec<Vec<String>>,
    /// Paths that its code names.
    pub(super) mentions: Vec<Mention>,
    /// Names of arguments and variables, which a path of one name may mean.
    pub(super) locals: HashSet<String>,
}

/// A path in the code, and where.
pub(super) struct Mention {
    pub(super) path: Vec<String>,
    pub(super) line: usize,
}

impl Module {
    /// Tells whether a path may be a variable: one small letter's name, which is one somewhere in this module.
    pub(super) fn is_local(&self, path: &[String]) -> bool {
        matches!(path, [name] if self.locals.contains(name) && !name.starts_with(char::is_uppercase))
    }
}

impl Tree {
    /// Reads the crate whose root is `file`, modules of tests left out.
    pub(super) fn read(file: &Path) -> Result<Self, String> {
        let mut tree = Self { modules: vec![Module { name: "crate".into(), file: file.into(), ..Module::default() }] };
        let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
        let items = parse(file)?;
        tree.fill(0, &items, &folder)?;
        Ok(tree)
    }

    /// As `a::b`, from the root.
    pub(super) fn path(&self, module: usize) -> String {
        match self.modules[module].parent {
            Some(parent) => format!("{}::{}", self.path(parent), self.modules[module].name),
            None => self.modules[module].name.clone(),
        }
    }

    /// Takes the items of a module in, and reads the modules below it, whose files are in `folder`.
    fn fill(&mut self, module: usize, items: &[Item], folder: &Path) -> Result<(), String> {
        for item in items.iter().filter(|item| !only_in_tests(attributes(item))) {
            let Item::Mod(below) = item else {
                Reader { module: &mut self.modules[module] }.visit_item(item);
                continue;
            };
            let name = below.ident.to_string();
            let id = self.modules.len();
            let child = Module { name: name.clone(), parent: Some(module), ..Module::default() };
            self.modules.push(child);
            self.modules[module].children.push(id);
            match &below.content {
                Some((_, items)) => {
                    self.modules[id].file = self.modules[module].file.clone();
                    self.fill(id, items, &folder.join(&name))?;
                }
                None => {
                    let (file, folder) = locate(&self.modules[module].file, folder, &name, &below.attrs);
                    let items = parse(&file)?;
                    self.modules[id].file = file;
                    self.fill(id, &items, &folder)?;
                }
            }
        }
        Ok(())
    }
}

/// The file of `mod name;`, and the folder of the modules below it.
fn locate(parent: &Path, folder: &Path, name: &str, attributes: &[Attribute]) -> (PathBuf, PathBuf) {
    let elsewhere = attributes.iter().filter(|a| a.path().is_ident("path")).find_map(|a| match &a.meta {
        syn::Meta::NameValue(pair) => text(&pair.value),
        _ => None,
    });
    if let Some(path) = elsewhere {
        let file = parent.parent().unwrap_or(Path::new("")).join(path);
        let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
        return (file, folder);
    }
    let (flat, deep) = (folder.join(format!("{name}.rs")), folder.join(name).join("mod.rs"));
    (if flat.is_file() { flat } else { deep }, folder.join(name))
}

fn parse(file: &Path) -> Result<Vec<Item>, String> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let parsed = syn::parse_file(&text);
    Ok(parsed.map_err(|e| format!("{}:{}: {e}", file.display(), e.span().start().line))?.items)
}

fn text(value: &syn::Expr) -> Option<String> {
    match value {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value()),
        _ => None,
    }
}

/// Tells whether an item is compiled for tests alone: `#[test]`, or `#[cfg(test)]` in any of its forms.
fn only_in_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let syn::Meta::List(list) = &attribute.meta else { return attribute.path().is_ident("test") };
        attribute.path().is_ident("cfg") && names_test(list.tokens.clone())
    })
}

fn names_test(tokens: TokenStream) -> bool {
    let mut negated = false;
    tokens.into_iter().any(|token| match token {
        TokenTree::Ident(name) => {
            negated = name == "not";
            name == "test"
        }
        TokenTree::Group(group) => !negated && names_test(group.stream()),
        _ => false,
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Enum(i) => &i.attrs,
        Item::ExternCrate(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Macro(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Static(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::Type(i) => &i.attrs,
        Item::Union(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}

fn defined_name(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(i) => &i.ident,
        Item::Enum(i) => &i.ident,
        Item::Fn(i) => &i.sig.ident,
        Item::Macro(i) => i.ident.as_ref()?,
        Item::Static(i) => &i.ident,
        Item::Struct(i) => &i.ident,
        Item::Trait(i) => &i.ident,
        Item::Type(i) => &i.ident,
        Item::Union(i) => &i.ident,
        _ => return None,
    };
    Some(name.to_string())
}

/// Walks the items of a module.
struct Reader<'a> {
    module: &'a mut Module,
}

impl Reader<'_> {
    fn mention(&mut self, path: Vec<String>, line: usize) {
        self.module.mentions.push(Mention { path, line });
    }

    /// An import that is passed on is no use: what it names is used where the name is.
    fn import(&mut self, tree: &UseTree, before: &[String], passed_on: bool) {
        let mut path = before.to_vec();
        match tree {
            UseTree::Path(step) => {
                path.push(step.ident.to_string());
                self.import(&step.tree, &path, passed_on);
            }
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.import(tree, before, passed_on)),
            UseTree::Glob(_) => self.module.globs.push(path),
            UseTree::Name(name) => self.bind(path, &name.ident, &name.ident, passed_on),
            UseTree::Rename(rename) => self.bind(path, &rename.ident, &rename.rename, passed_on),
        }
    }

    fn bind(&mut self, mut path: Vec<String>, source: &syn::Ident, name: &syn::Ident, passed_on: bool) {
        // `use a::b::{self}` imports `a::b`.
        let mut name = name.to_string();
        if source == "self" {
            if name == "self" {
                name = path.last().cloned().unwrap_or_default();
            }
        } else {
            path.push(source.to_string());
        }
        if !passed_on {
            self.mention(path.clone(), source.span().start().line);
        }
        self.module.bindings.push((name, path));
    }

    /// Paths among the tokens of a macro, which cannot be parsed in general.
    fn tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut i = 0;
        while i < tokens.len() {
            match &tokens[i] {
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Ident(first) if !is_punct(tokens.get(i.wrapping_sub(1)), '.') => {
                    let line = first.span().start().line;
                    let (path, next) = path_at(&tokens, i);
                    let upper = path[0].starts_with(char::is_uppercase);
                    let called = matches!(tokens.get(next), Some(TokenTree::Group(g)) if g.delimiter() == Delimiter::Parenthesis)
                        || is_punct(tokens.get(next), '!');
                    if path.len() > 1 || upper || called {
                        self.mention(path, line);
                    }
                    i = next;
                    continue;
                }
                _ => {}
            }
            i += 1;
        }
    }
}

/// The path that starts with the identifier at `i`, and the place after it.
fn path_at(tokens: &[TokenTree], mut i: usize) -> (Vec<String>, usize) {
    let mut path = Vec::new();
    while let Some(TokenTree::Ident(name)) = tokens.get(i) {
        path.push(name.to_string());
        i += 1;
        let goes_on = is_punct(tokens.get(i), ':')
            && is_punct(tokens.get(i + 1), ':')
            && matches!(tokens.get(i + 2), Some(TokenTree::Ident(_)));
        if !goes_on {
            break;
        }
        i += 2;
    }
    (path, i)
}

fn is_punct(token: Option<&TokenTree>, mark: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == mark)
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if only_in_tests(attributes(item)) {
            return;
        }
        if let Some(name) = defined_name(item) {
            if matches!(item, Item::Macro(_)) {
                self.module.macros.insert(name.clone());
            }
            self.module.defined.insert(name);
        }
        syn::visit::visit_item(self, item);
    }

    fn visit_impl_item(&mut self, item: &'ast syn::ImplItem) {
        let for_tests = matches!(item, syn::ImplItem::Fn(function) if only_in_tests(&function.attrs));
        if !for_tests {
            syn::visit::visit_impl_item(self, item);
        }
    }

    fn visit_pat_ident(&mut self, pattern: &'ast syn::PatIdent) {
        self.module.locals.insert(pattern.ident.to_string());
        syn::visit::visit_pat_ident(self, pattern);
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        let passed_on = !matches!(item.vis, syn::Visibility::Inherited);
        self.import(&item.tree, &[], passed_on);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            let names = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            self.mention(names, path.span().start().line);
        }
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        self.visit_path(&item.path);
        self.tokens(item.tokens.clone());
    }

    /// Attributes name paths too, some of them in quotes: `#[serde(with = "crate::units")]`.
    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if attribute.path().is_ident("doc") {
            return;
        }
        let syn::Meta::List(list) = &attribute.meta else { return };
        self.tokens(list.tokens.clone());
        for token in list.tokens.clone() {
            let TokenTree::Literal(literal) = token else { continue };
            let Ok(text) = syn::parse_str::<syn::LitStr>(&literal.to_string()) else { continue };
            if let Ok(path) = text.parse::<syn::Path>() {
                let line = literal.span().start().line;
                self.mention(path.segments.iter().map(|s| s.ident.to_string()).collect(), line);
            }
        }
    }
}
