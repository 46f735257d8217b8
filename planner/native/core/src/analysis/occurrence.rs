//! Every occurrence of every name, for editors: definition, references, rename, hover.
//!
//! Works on the tree, so that it also covers what the typed model leaves out as faulty.

use rustc_hash::FxHashSet;

use crate::pddl::model::{Domain, Problem};
use crate::syntax::span::Span;
use crate::syntax::tree::{Node, NodeKind, Tree};

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SymbolKind {
    /// A domain.
    Domain,
    /// A problem.
    Problem,
    /// A type.
    Type,
    /// A constant or object.
    Object,
    /// A predicate.
    Predicate,
    /// A numeric function.
    Function,
    /// A module of PDDL/M.
    Module,
    /// An action.
    Action,
    /// A parameter or quantified variable.
    Variable,
}

impl SymbolKind {
    /// The word shown to people.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Domain => "domain",
            Self::Problem => "problem",
            Self::Type => "type",
            Self::Object => "object",
            Self::Predicate => "predicate",
            Self::Function => "function",
            Self::Module => "module",
            Self::Action => "action",
            Self::Variable => "variable",
        }
    }
}

/// A name somewhere in a file. Two occurrences name the same thing if kind, name and scope agree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Occurrence {
    /// What it stands for.
    pub kind: SymbolKind,
    /// Lower-cased.
    pub name: String,
    /// Where.
    pub span: Span,
    /// Whether it is declared here.
    pub definition: bool,
    /// First byte of the list that introduces a variable; 0 for everything else.
    pub scope: u32,
    /// The list that declares the name: signature, action or typed group.
    pub declaration: Option<Span>,
}

/// All occurrences of a file in the order of the text. `problem` is the file's own, if it is one.
#[must_use]
pub fn occurrences(
    tree: &Tree,
    domain: Option<&Domain>,
    problem: Option<&Problem>,
) -> Vec<Occurrence> {
    let mut finder = Finder::new(domain, problem);
    for root in tree.roots() {
        finder.definition(root);
    }
    finder.found.sort_by_key(|occurrence| occurrence.span);
    finder.found
}

struct Finder<'m> {
    predicates: FxHashSet<&'m str>,
    functions: FxHashSet<&'m str>,
    objects: FxHashSet<&'m str>,
    /// Variables in scope and where they are introduced.
    scopes: Vec<(String, u32)>,
    found: Vec<Occurrence>,
}

fn lower(node: Node<'_>) -> String {
    node.text().to_ascii_lowercase()
}

fn head_word(node: Node<'_>) -> String {
    node.head()
        .filter(|head| head.word().is_some())
        .map_or_else(String::new, lower)
}

impl<'m> Finder<'m> {
    fn new(domain: Option<&'m Domain>, problem: Option<&'m Problem>) -> Self {
        let mut finder = Self {
            predicates: FxHashSet::default(),
            functions: FxHashSet::default(),
            objects: FxHashSet::default(),
            scopes: Vec::new(),
            found: Vec::new(),
        };
        if let Some(domain) = domain {
            let predicates = domain.predicates.iter();
            finder
                .predicates
                .extend(predicates.map(|p| p.name.text.as_str()));
            let functions = domain.functions.iter();
            finder
                .functions
                .extend(functions.map(|f| f.name.text.as_str()));
            let constants = domain.constants.iter();
            finder
                .objects
                .extend(constants.map(|o| o.name.text.as_str()));
        }
        if let Some(problem) = problem {
            let objects = problem.objects.iter();
            finder.objects.extend(objects.map(|o| o.name.text.as_str()));
        }
        finder
    }

    fn add(&mut self, kind: SymbolKind, node: Node<'_>, declaration: Option<Span>) {
        self.add_scoped(kind, node, declaration, 0);
    }

    fn add_scoped(
        &mut self,
        kind: SymbolKind,
        node: Node<'_>,
        declaration: Option<Span>,
        scope: u32,
    ) {
        if node.word().is_some() {
            self.found.push(Occurrence {
                kind,
                name: lower(node),
                span: node.span(),
                definition: declaration.is_some(),
                scope,
                declaration,
            });
        }
    }

    fn definition(&mut self, root: Node<'_>) {
        if head_word(root) != "define" {
            return;
        }
        for section in root.children().skip(1) {
            let rest = section.children().skip(1);
            match head_word(section).as_str() {
                "domain" => rest.take(1).for_each(|name| {
                    self.add(SymbolKind::Domain, name, Some(section.span()));
                }),
                "problem" => rest.take(1).for_each(|name| {
                    self.add(SymbolKind::Problem, name, Some(section.span()));
                }),
                ":domain" => rest
                    .take(1)
                    .for_each(|name| self.add(SymbolKind::Domain, name, None)),
                ":types" => self.typed(rest, Some(SymbolKind::Type), 0),
                ":constants" | ":objects" => self.typed(rest, Some(SymbolKind::Object), 0),
                ":predicates" => rest.for_each(|list| self.signature(SymbolKind::Predicate, list)),
                ":functions" => rest.for_each(|list| self.signature(SymbolKind::Function, list)),
                ":modules" => rest.for_each(|list| self.signature(SymbolKind::Module, list)),
                ":action" | ":durative-action" => self.action(section),
                ":derived" => self.rule(section),
                ":init" | ":goal" => rest.for_each(|node| self.body(node)),
                ":metric" => rest.skip(1).for_each(|node| self.body(node)),
                _ => {}
            }
        }
    }

    /// `a b - t`: names declared (variables with a scope), types referred to.
    fn typed<'t>(
        &mut self,
        nodes: impl Iterator<Item = Node<'t>>,
        kind: Option<SymbolKind>,
        scope: u32,
    ) {
        let nodes: Vec<Node<'t>> = nodes.collect();
        let mut group = 0;
        let mut position = 0;
        while position < nodes.len() {
            let node = nodes[position];
            if node.word() != Some("-") {
                position += 1;
                continue;
            }
            let end = nodes
                .get(position + 1)
                .map_or(node.span(), |kind| kind.span());
            self.group(&nodes[group..position], end, kind, scope);
            if let Some(&types) = nodes.get(position + 1) {
                self.type_reference(types);
            }
            position += 2;
            group = position;
        }
        if let Some(last) = nodes.last() {
            let rest = nodes.get(group..).unwrap_or_default();
            self.group(rest, last.span(), kind, scope);
        }
    }

    fn group(&mut self, nodes: &[Node<'_>], end: Span, kind: Option<SymbolKind>, scope: u32) {
        for &node in nodes {
            let declaration = Some(node.span().join(end));
            if node.word().is_some_and(|word| word.starts_with('?')) {
                self.scopes.push((lower(node), scope));
                self.add_scoped(SymbolKind::Variable, node, declaration, scope);
            } else if let Some(kind) = kind {
                self.add(kind, node, declaration);
            } else if !node.is_list() {
                continue;
            } else {
                self.body(node);
            }
        }
    }

    fn type_reference(&mut self, node: Node<'_>) {
        match node.kind() {
            NodeKind::Word => self.add(SymbolKind::Type, node, None),
            _ => node
                .children()
                .skip(1)
                .for_each(|part| self.add(SymbolKind::Type, part, None)),
        }
    }

    /// `(name ?x - t ...)`, for modules with fluents, kind and provider behind.
    fn signature(&mut self, kind: SymbolKind, list: Node<'_>) {
        let Some(head) = list.head().filter(|_| list.is_list()) else {
            return;
        };
        self.add(kind, head, Some(list.span()));
        let outside = self.scopes.len();
        self.typed(list.children().skip(1), None, list.span().start);
        self.scopes.truncate(outside);
    }

    fn action(&mut self, section: Node<'_>) {
        let mut parts = section.children().skip(1).peekable();
        if let Some(name) = parts.next_if(|part| part.word().is_some()) {
            self.add(SymbolKind::Action, name, Some(section.span()));
        }
        let parts: Vec<Node<'_>> = parts.collect();
        let outside = self.scopes.len();
        let value_of = |key: &str| {
            let position = parts.iter().position(|part| lower(*part) == key)?;
            parts.get(position + 1).copied()
        };
        if let Some(parameters) = value_of(":parameters") {
            self.typed(parameters.children(), None, section.span().start);
        }
        for key in [":duration", ":condition", ":precondition", ":effect"] {
            if let Some(value) = value_of(key) {
                self.body(value);
            }
        }
        self.scopes.truncate(outside);
    }

    fn rule(&mut self, section: Node<'_>) {
        let mut parts = section.children().skip(1);
        let outside = self.scopes.len();
        if let Some(head) = parts.next() {
            if let Some(name) = head.head() {
                self.add(SymbolKind::Predicate, name, None);
            }
            self.typed(head.children().skip(1), None, section.span().start);
        }
        parts.for_each(|body| self.body(body));
        self.scopes.truncate(outside);
    }

    fn body(&mut self, node: Node<'_>) {
        match node.kind() {
            NodeKind::Word => self.word(node),
            NodeKind::Call => {
                if let Some(head) = node.head() {
                    self.add(SymbolKind::Module, head, None);
                }
                node.children().skip(1).for_each(|part| self.body(part));
            }
            NodeKind::List => self.list(node),
        }
    }

    fn word(&mut self, node: Node<'_>) {
        let name = lower(node);
        if name.starts_with('?') {
            let scope = self.scopes.iter().rev().find(|(known, _)| *known == name);
            if let Some(&(_, scope)) = scope {
                self.add_scoped(SymbolKind::Variable, node, None, scope);
            }
        } else if self.objects.contains(name.as_str()) {
            self.add(SymbolKind::Object, node, None);
        } else if self.functions.contains(name.as_str()) {
            self.add(SymbolKind::Function, node, None);
        }
    }

    fn list(&mut self, node: Node<'_>) {
        let Some(head) = node.head().filter(|head| head.word().is_some()) else {
            node.children().for_each(|part| self.body(part));
            return;
        };
        let name = lower(head);
        let mut rest = node.children().skip(1);
        if matches!(name.as_str(), "forall" | "exists") {
            let outside = self.scopes.len();
            if let Some(variables) = rest.next() {
                self.typed(variables.children(), None, node.span().start);
            }
            rest.for_each(|part| self.body(part));
            self.scopes.truncate(outside);
            return;
        }
        let timed = matches!(name.as_str(), "at" | "over")
            && node
                .children()
                .nth(2)
                .is_some_and(|part| part.kind() != NodeKind::Word);
        if timed {
            rest.skip(1).for_each(|part| self.body(part));
            return;
        }
        if self.predicates.contains(name.as_str()) {
            self.add(SymbolKind::Predicate, head, None);
        } else if self.functions.contains(name.as_str()) {
            self.add(SymbolKind::Function, head, None);
        }
        rest.for_each(|part| self.body(part));
    }
}
