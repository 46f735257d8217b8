//! The type hierarchy: reading `(:types ...)`, resolving type names, subtype tests.

use rustc_hash::{FxHashMap, FxHashSet};

use super::names::{Names, lower, name};
use super::requirements::Feature;
use super::sink::Sink;
use super::typed_list::{MAXIMUM_MEMBERS, too_many, typed_list};
use crate::pddl::model::{Name, TypeDeclaration, TypeId};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::span::Span;
use crate::syntax::suggestion::nearest;
use crate::syntax::tree::Node;

/// The root of the hierarchy.
pub(super) const OBJECT: TypeId = TypeId(0);

/// The hierarchy of a domain without `(:types ...)`.
pub(super) fn root(definition: Span) -> TypeDeclaration {
    TypeDeclaration {
        name: Name {
            text: "object".to_owned(),
            span: Span::new(definition.start, definition.start),
        },
        parents: Vec::new(),
    }
}

/// Reads `(:types ...)`; `types` holds `object` only.
pub(super) fn read(
    section: Node<'_>,
    types: &mut Vec<TypeDeclaration>,
    names: &mut Names,
    sink: &mut Sink,
) {
    sink.uses(Feature::Typing, section.first_token_span());
    let groups = typed_list(section.children().skip(1), sink);
    for member in groups.iter().flat_map(|group| &group.members) {
        if member.word().is_none() {
            sink.expected(member.span(), "the name of a type", Some(*member));
            continue;
        }
        let declared = name(*member);
        if declared.text == "object" {
            continue;
        }
        if let Some(&earlier) = names.types.get(&declared.text) {
            sink.push(
                Diagnostic::new(
                    Code::DuplicateDeclaration,
                    declared.span,
                    format!("type `{}` is declared twice", declared.text),
                )
                .label("a second supertype is added")
                .note(types[earlier.index()].name.span, "declared here first")
                .warning(),
            );
            continue;
        }
        declare(declared, types, names);
    }
    for group in &groups {
        let parents = match group.types {
            Some(node) => supertypes(node, types, names, sink),
            None => vec![OBJECT],
        };
        for member in &group.members {
            let Some(&id) = names.types.get(lower(member.text()).as_ref()) else {
                continue;
            };
            if id == OBJECT {
                continue;
            }
            let own = &mut types[id.index()].parents;
            for &parent in &parents {
                if !own.contains(&parent) {
                    own.push(parent);
                }
            }
        }
    }
    break_cycles(types, sink);
    for declaration in types.iter_mut().skip(1) {
        if declaration.parents.len() > 1 {
            declaration.parents.retain(|&parent| parent != OBJECT);
        }
        if declaration.parents.is_empty() {
            declaration.parents.push(OBJECT);
        }
    }
}

fn declare(declared: Name, types: &mut Vec<TypeDeclaration>, names: &mut Names) -> TypeId {
    let id = TypeId(types.len() as u32);
    names.types.insert(declared.text.clone(), id);
    types.push(TypeDeclaration {
        name: declared,
        parents: Vec::new(),
    });
    id
}

/// Supertypes may be used without a declaration of their own.
fn supertypes(
    node: Node<'_>,
    types: &mut Vec<TypeDeclaration>,
    names: &mut Names,
    sink: &mut Sink,
) -> Vec<TypeId> {
    alternatives(node, sink)
        .into_iter()
        .map(|part| {
            let written = name(part);
            if let Some(&id) = names.types.get(&written.text) {
                return id;
            }
            sink.report(Code::ImplicitType, || {
                let known = types.iter().map(|declared| declared.name.text.as_str());
                Diagnostic::new(
                    Code::ImplicitType,
                    written.span,
                    format!("supertype `{}` is not declared itself", written.text),
                )
                .label("taken as a subtype of `object`")
                .did_you_mean(nearest(&written.text, known))
            });
            let id = declare(written, types, names);
            types[id.index()].parents.push(OBJECT);
            id
        })
        .collect()
}

/// The words of `t` or `(either t u)`.
fn alternatives<'t>(node: Node<'t>, sink: &mut Sink) -> Vec<Node<'t>> {
    if node.word().is_some() {
        return vec![node];
    }
    let mut parts = node.children();
    let either = parts
        .next()
        .is_some_and(|head| head.text().eq_ignore_ascii_case("either"));
    if !node.is_list() || !either {
        sink.expected(node.span(), "a type or `(either ...)`", Some(node));
        return Vec::new();
    }
    let words: Vec<Node<'t>> = parts
        .filter(|part| part.word().is_some())
        .take(MAXIMUM_MEMBERS + 1)
        .collect();
    if words.len() > MAXIMUM_MEMBERS {
        sink.push(too_many(node, "types in one `either`"));
        return Vec::new();
    }
    if words.is_empty() {
        sink.expected(node.span(), "types behind `either`", None);
    }
    words
}

fn break_cycles(types: &mut [TypeDeclaration], sink: &mut Sink) {
    /// Not visited, on the path, done.
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        Open,
        Done,
    }
    let mut marks = vec![Mark::New; types.len()];
    for start in 0..types.len() {
        let mut path = vec![(start, 0)];
        if marks[start] != Mark::New {
            continue;
        }
        marks[start] = Mark::Open;
        while let Some((current, next)) = path.last_mut() {
            let current = *current;
            let Some(&parent) = types[current].parents.get(*next) else {
                marks[current] = Mark::Done;
                path.pop();
                continue;
            };
            match marks[parent.index()] {
                Mark::Done => *next += 1,
                Mark::New => {
                    *next += 1;
                    marks[parent.index()] = Mark::Open;
                    path.push((parent.index(), 0));
                }
                Mark::Open => {
                    let position = *next;
                    types[current].parents.remove(position);
                    let declared = &types[current].name;
                    sink.push(
                        Diagnostic::new(
                            Code::CyclicType,
                            declared.span,
                            format!("type `{}` is its own supertype", declared.text),
                        )
                        .label(format!(
                            "its supertype `{}` is also below it",
                            types[parent.index()].name.text
                        ))
                        .note(types[parent.index()].name.span, "declared here"),
                    );
                }
            }
        }
    }
}

/// Resolves `t` or `(either t u)` where a type has to be declared; `object` where none is written.
pub(super) fn resolve(
    node: Option<Node<'_>>,
    types: &[TypeDeclaration],
    names: &Names,
    sink: &mut Sink,
) -> Vec<TypeId> {
    let Some(node) = node else {
        return vec![OBJECT];
    };
    sink.uses(Feature::Typing, node.span());
    let mut resolved = Vec::new();
    for part in alternatives(node, sink) {
        let written = lower(part.text());
        if let Some(&id) = names.types.get(written.as_ref()) {
            if !resolved.contains(&id) {
                resolved.push(id);
            }
            continue;
        }
        sink.report(Code::UnknownType, || {
            let known = types.iter().map(|declared| declared.name.text.as_str());
            let suggestion = nearest(&written, known);
            let diagnostic = Diagnostic::new(
                Code::UnknownType,
                part.span(),
                format!("unknown type `{}`", part.text()),
            )
            .label("not declared in (:types ...)");
            match suggestion {
                Some(_) => diagnostic.did_you_mean(suggestion),
                None => diagnostic.remedy(format!("declare `{written}` in (:types ...)")),
            }
        });
    }
    if resolved.is_empty() {
        resolved.push(OBJECT);
    }
    resolved
}

/// `robot`, or `(either a b)`.
pub(super) fn display(set: &[TypeId], types: &[TypeDeclaration]) -> String {
    let words: Vec<&str> = set
        .iter()
        .map(|id| types[id.index()].name.text.as_str())
        .collect();
    match words.as_slice() {
        [one] => (*one).to_owned(),
        several => format!("(either {})", several.join(" ")),
    }
}

/// How the values of one set of types relate to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    /// Every value fits.
    All,
    /// Some values fit.
    Some,
    /// None can.
    None,
}

/// Subtype tests with memory.
pub(super) struct Hierarchy<'d> {
    types: &'d [TypeDeclaration],
    subtype: FxHashMap<(TypeId, TypeId), bool>,
    overlap: FxHashMap<(Vec<TypeId>, Vec<TypeId>), bool>,
}

impl<'d> Hierarchy<'d> {
    pub fn new(types: &'d [TypeDeclaration]) -> Self {
        Self {
            types,
            subtype: FxHashMap::default(),
            overlap: FxHashMap::default(),
        }
    }

    /// Whether every object of type `below` is of type `above`.
    pub fn is_subtype(&mut self, below: TypeId, above: TypeId) -> bool {
        if below == above || above == OBJECT {
            return true;
        }
        if let Some(&known) = self.subtype.get(&(below, above)) {
            return known;
        }
        let mut open = vec![below];
        let mut seen: FxHashSet<TypeId> = open.iter().copied().collect();
        while let Some(current) = open.pop() {
            let parents = self.types[current.index()].parents.iter();
            open.extend(parents.copied().filter(|&parent| seen.insert(parent)));
        }
        let found = seen.contains(&above);
        self.subtype.insert((below, above), found);
        found
    }

    /// How a variable of the types `given` fits a parameter of the types `wanted`.
    pub fn fit(&mut self, given: &[TypeId], wanted: &[TypeId]) -> Fit {
        let inside = given
            .iter()
            .all(|&below| wanted.iter().any(|&above| self.is_subtype(below, above)));
        if inside {
            return Fit::All;
        }
        let key = (given.to_vec(), wanted.to_vec());
        let overlap = match self.overlap.get(&key) {
            Some(&known) => known,
            None => {
                let (ours, theirs) = (self.below(given), self.below(wanted));
                let common = ours.iter().zip(&theirs).any(|(&our, &their)| our && their);
                self.overlap.insert(key, common);
                common
            }
        };
        if overlap { Fit::Some } else { Fit::None }
    }

    /// For every type whether it is below one of `roots`.
    fn below(&self, roots: &[TypeId]) -> Vec<bool> {
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); self.types.len()];
        for (index, declaration) in self.types.iter().enumerate() {
            for parent in &declaration.parents {
                children[parent.index()].push(index);
            }
        }
        let mut below = vec![false; self.types.len()];
        let mut open: Vec<usize> = roots.iter().map(|id| id.index()).collect();
        while let Some(current) = open.pop() {
            if !std::mem::replace(&mut below[current], true) {
                open.extend(&children[current]);
            }
        }
        below
    }
}
