//! Which modules of a crate know which, read from its sources: imports and paths in code, unit tests apart.
//!
//! A name is followed through re-exports to the module that defines it, so a parent that only re-exports counts for
//! nothing, and nor does what a parent defines or imports itself.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A module's path from the crate's root, which is empty.
pub type ModulePath = Vec<String>;

/// The modules of a crate.
pub struct Modules(BTreeMap<ModulePath, Module>);

/// That one of a parent's direct children knows another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edge {
    /// The child that imports.
    pub from: String,
    /// The child that is imported from.
    pub to: String,
    /// The modules at both ends in full, as `gap::search -> gap::effects::floor`.
    pub witness: String,
}

/// What a module's source says, before it is known which names are modules.
#[derive(Default)]
struct Module {
    /// Paths as written, each with the name that it is imported as.
    imports: Vec<(ModulePath, String)>,
    /// Paths as written in code.
    mentions: Vec<ModulePath>,
}

impl Modules {
    /// Reads the sources of a library in a folder; a `main.rs` is another crate and left out.
    ///
    /// # Panics
    /// When the folder cannot be read or a file is no Rust.
    pub fn read(folder: &Path) -> Self {
        let mut sources = Vec::new();
        collect(folder, &[], &mut sources);
        Modules::new(sources.iter().map(|(path, text)| (path.clone(), text.as_str())))
    }

    /// Reads sources, each with its module's path.
    ///
    /// # Panics
    /// When one is no Rust.
    pub fn new<'t>(sources: impl IntoIterator<Item = (ModulePath, &'t str)>) -> Self {
        let mut reader = Reader { modules: BTreeMap::from([(Vec::new(), Module::default())]), tests: Vec::new() };
        for (path, text) in sources {
            let tokens: TokenStream = text.parse().unwrap_or_else(|e| panic!("{}: {e}", path.join("::")));
            reader.read(&path, tokens);
        }
        let Reader { mut modules, tests } = reader;
        modules.retain(|path, _| !tests.iter().any(|test| path.starts_with(test)));
        Modules(modules)
    }

    /// The names of a parent's direct children.
    pub fn children(&self, parent: &[String]) -> BTreeSet<&str> {
        self.0.keys().filter_map(|path| Some(path.strip_prefix(parent)?.first()?.as_str())).collect()
    }

    /// Every module that has children.
    pub fn parents(&self) -> impl Iterator<Item = &ModulePath> {
        self.0.keys().filter(|path| !self.children(path).is_empty())
    }

    /// Which of a parent's children know which, each pair once.
    pub fn edges(&self, parent: &[String]) -> Vec<Edge> {
        let mut edges: BTreeMap<(&str, String), String> = BTreeMap::new();
        for (path, module) in &self.0 {
            let Some(from) = path.strip_prefix(parent).and_then(|below| below.first()) else { continue };
            let named = module.imports.iter().map(|(named, _)| named).chain(&module.mentions);
            for target in named.filter_map(|named| self.definer(path, named)) {
                let Some(to) = target.strip_prefix(parent).and_then(|below| below.first()) else { continue };
                if from != to {
                    let witness = || format!("{} -> {}", path.join("::"), target.join("::"));
                    edges.entry((from, to.clone())).or_insert_with(witness);
                }
            }
        }
        edges.into_iter().map(|((from, to), witness)| Edge { from: from.into(), to, witness }).collect()
    }

    /// The module that defines what `named` means in the module `path`; none for other crates.
    fn definer(&self, path: &[String], named: &[String]) -> Option<ModulePath> {
        let mut named = self.absolute(path, named)?;
        // Each round follows one re-export; a circle of them does not compile.
        loop {
            let depth = (0..=named.len()).rev().find(|depth| self.0.contains_key(&named[..*depth]))?;
            let (module, rest) = named.split_at(depth);
            let imported = rest.first().and_then(|name| {
                let imports = &self.0[module].imports;
                imports.iter().find(|(_, known_as)| known_as == name).map(|(path, _)| path)
            });
            // What comes from another crate is no module's own, but the module that imports it passes it on.
            match imported.and_then(|path| self.absolute(module, path)) {
                Some(path) if path != named => named = path.into_iter().chain(rest[1..].iter().cloned()).collect(),
                _ => return Some(module.to_vec()),
            }
        }
    }

    /// A path as written in the module `path`, from the crate's root.
    fn absolute(&self, path: &[String], named: &[String]) -> Option<ModulePath> {
        let supers = named.iter().take_while(|name| *name == "super").count();
        let (base, rest) = match named.first()?.as_str() {
            "crate" => (&path[..0], &named[1..]),
            "self" => (path, &named[1..]),
            "super" => (&path[..path.len().checked_sub(supers)?], &named[supers..]),
            _ => (path, named),
        };
        let joined = [base, rest].concat();
        let is_ours = rest.len() < named.len() || self.0.contains_key(&joined[..base.len() + 1]);
        is_ours.then_some(joined)
    }
}

/// The edges from whose end a way leads back to their beginning.
pub fn in_circles(edges: &[Edge]) -> Vec<Edge> {
    edges.iter().filter(|edge| leads(edges, &edge.to, &edge.from)).cloned().collect()
}

fn leads(edges: &[Edge], from: &str, to: &str) -> bool {
    let mut reached = BTreeSet::from([from]);
    loop {
        let before = reached.len();
        let next = edges.iter().filter(|edge| reached.contains(edge.from.as_str())).map(|edge| edge.to.as_str());
        let next: Vec<&str> = next.collect();
        reached.extend(next);
        if reached.len() == before {
            return reached.contains(to);
        }
    }
}

fn collect(folder: &Path, module: &[String], sources: &mut Vec<(ModulePath, String)>) {
    for entry in fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())) {
        let path = entry.expect("an entry that can be read").path();
        let name = path.file_stem().and_then(|stem| stem.to_str()).expect("a name in UTF-8");
        let inner = [module, &[name.to_owned()]].concat();
        if path.is_dir() {
            collect(&path, &inner, sources);
        } else if path.extension().is_some_and(|extension| extension == "rs") && name != "main" {
            let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            sources.push((if name == "lib" { module.to_vec() } else { inner }, text));
        }
    }
}

/// Goes through tokens, so that comments and strings say nothing and the insides of macros do.
struct Reader {
    modules: BTreeMap<ModulePath, Module>,
    /// Modules that exist only in unit tests.
    tests: Vec<ModulePath>,
}

impl Reader {
    fn read(&mut self, module: &[String], tokens: TokenStream) {
        self.modules.entry(module.to_vec()).or_default();
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < tokens.len() {
            at += self.item(module, &tokens[at..]);
        }
    }

    /// Reads what begins here; returns how many tokens that is.
    fn item(&mut self, module: &[String], tokens: &[TokenTree]) -> usize {
        match tokens {
            [hash, TokenTree::Group(attribute), item @ ..] if is(hash, "#") && is_cfg_test(attribute.stream()) => {
                2 + self.skip(module, item)
            }
            [keyword, TokenTree::Ident(name), TokenTree::Group(body), ..] if is(keyword, "mod") => {
                self.read(&[module, &[name.to_string()]].concat(), body.stream());
                3
            }
            // `use<'a>` in a type is no import.
            [keyword, next, ..] if is(keyword, "use") && !is(next, "<") => {
                let mut leaves = Vec::new();
                let length = tree(&[], &tokens[1..], &mut leaves);
                self.modules.entry(module.to_vec()).or_default().imports.extend(leaves);
                1 + length
            }
            [root, colon, ..] if ["crate", "super", "self"].iter().any(|r| is(root, r)) && is(colon, ":") => {
                let mut leaves = Vec::new();
                let length = tree(&[], tokens, &mut leaves);
                let mentions = leaves.into_iter().map(|(path, _)| path);
                self.modules.entry(module.to_vec()).or_default().mentions.extend(mentions);
                length
            }
            [TokenTree::Group(group), ..] => {
                self.read(module, group.stream());
                1
            }
            _ => 1,
        }
    }

    /// Passes over the item of a unit test; returns how many tokens it has.
    fn skip(&mut self, module: &[String], item: &[TokenTree]) -> usize {
        if let [keyword, TokenTree::Ident(name), ..] = item
            && is(keyword, "mod")
        {
            self.tests.push([module, &[name.to_string()]].concat());
        }
        let ends = |token: &TokenTree| {
            matches!(token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace) || is(token, ";")
        };
        item.iter().position(ends).map_or(item.len(), |end| end + 1)
    }
}

/// Reads a path or a tree of them; returns how many tokens it has.
fn tree(prefix: &[String], tokens: &[TokenTree], leaves: &mut Vec<(ModulePath, String)>) -> usize {
    let mut path = prefix.to_vec();
    let mut at = 0;
    loop {
        match &tokens[at..] {
            [TokenTree::Ident(name), rest @ ..] => {
                path.push(name.to_string());
                at += 1;
                if rest.first().is_some_and(|next| is(next, ":")) {
                    at += 2;
                    continue;
                }
            }
            [TokenTree::Group(group), ..] if group.delimiter() == Delimiter::Brace => {
                let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                let mut from = 0;
                while from < inner.len() {
                    // The comma after it too.
                    from += tree(&path, &inner[from..], leaves) + 1;
                }
                return at + 1;
            }
            // What all is imported by a star, or which type a function is called with, is for the compiler to know.
            [star, ..] if is(star, "*") => at += 1,
            // The path of another crate from its root.
            [colon, ..] if path.is_empty() && is(colon, ":") => return at + 2,
            _ => {}
        }
        if path.len() > 1 && path.last().is_some_and(|name| name == "self") {
            path.pop();
        }
        let mut known_as = path.last().cloned().unwrap_or_default();
        if let [keyword, TokenTree::Ident(name), ..] = &tokens[at..]
            && is(keyword, "as")
        {
            known_as = name.to_string();
            at += 2;
        }
        leaves.push((path, known_as));
        return at.max(1);
    }
}

fn is(token: &TokenTree, text: &str) -> bool {
    match token {
        TokenTree::Ident(ident) => ident == text,
        TokenTree::Punct(punct) => text.chars().eq([punct.as_char()]),
        _ => false,
    }
}

fn is_cfg_test(attribute: TokenStream) -> bool {
    attribute.to_string().replace(' ', "") == "cfg(test)"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> ModulePath {
        text.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect()
    }

    fn modules(sources: &[(&str, &str)]) -> Modules {
        Modules::new(sources.iter().map(|(module, text)| (path(module), *text)))
    }

    /// The edges below a parent, as `from>to`.
    fn edges(parent: &str, sources: &[(&str, &str)]) -> Vec<String> {
        modules(sources).edges(&path(parent)).iter().map(|edge| format!("{}>{}", edge.from, edge.to)).collect()
    }

    #[test]
    fn every_way_to_name_a_module_counts() {
        for source in [
            "use crate::low::Thing;",
            "use crate::{other::X, low::{self, deep::Y}};",
            "use super::low::*;",
            "pub use crate::low as high;",
            "fn f() -> u8 { crate::low::g::<u8>() }",
            "fn f() { println!(\"{}\", super::low::g()) }",
            "mod inner { use super::super::low::Thing; }",
            "impl crate::low::Trait for X {}",
        ] {
            assert_eq!(edges("", &[("top", source), ("low", "mod deep {}")]), ["top>low"], "{source}");
        }
    }

    #[test]
    fn what_only_looks_like_an_import_does_not_count() {
        for source in [
            "// use crate::low::Thing;",
            "/// See [`crate::low`].\nfn f() -> &'static str { \"crate::low::Thing\" }",
            "use low::Thing;",
            "pub(crate) fn low(self: &Self) { self.low::<u8>() }",
            "#[cfg(test)]\nmod tests { use crate::low::Thing; }",
            "#[cfg(test)]\nuse crate::low::Thing;",
            "fn f<'a>() -> impl Sized + use<'a> { other::low() }",
        ] {
            assert_eq!(edges("", &[("top", source), ("low", "")]), [""; 0], "{source}");
        }
        let test_in_its_file =
            [("top", "#[cfg(test)]\nmod tests;"), ("top::tests", "use crate::low::Thing;"), ("low", "")];
        assert_eq!(edges("", &test_in_its_file), [""; 0]);
    }

    #[test]
    fn a_circle_is_found_through_several_modules_and_files_below() {
        let sources = [
            ("room", "mod a; mod b; mod c; mod d; pub use c::Thing;"),
            ("room::a", "use super::b::X;"),
            ("room::b", ""),
            ("room::b::deep", "use crate::room::Thing;"),
            ("room::c", "use super::a::Y;"),
            ("room::d", "use super::a::Y;"),
        ];
        let found = in_circles(&modules(&sources).edges(&path("room")));
        let witnesses: Vec<&str> = found.iter().map(|edge| edge.witness.as_str()).collect();
        assert_eq!(witnesses, ["room::a -> room::b", "room::b::deep -> room::c", "room::c -> room::a"]);
        let broken = sources.map(|(module, text)| (module, if module == "room::c" { "" } else { text }));
        assert_eq!(in_circles(&modules(&broken).edges(&path("room"))), []);
    }

    #[test]
    fn a_parents_own_items_make_no_edge_and_its_imports_lead_on() {
        let sources = [
            ("room", "mod a; mod b; use b::Passed as Known; use crate::outside::Other; struct Own;"),
            ("room::a", "use super::{Known, Other, Own};"),
            ("room::b", "use crate::room::Own;"),
            ("outside", ""),
        ];
        assert_eq!(edges("room", &sources), ["a>b"]);
        assert_eq!(edges("", &sources), ["room>outside"]);
    }
}
