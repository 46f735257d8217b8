//! What can be written at a place, for editors.

use super::occurrence::SymbolKind;
use crate::pddl::model::{Domain, Parameter, Problem};
use crate::pddl::{parameter_list, supported_flags};
use crate::syntax::lexer::TokenKind;
use crate::syntax::tree::{Node, NodeKind, Tree};

/// Something that can be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// The text to write.
    pub text: String,
    /// What it stands for; `None` for a word of the language.
    pub kind: Option<SymbolKind>,
    /// Its signature or type.
    pub detail: String,
}

const DOMAIN_SECTIONS: [&str; 9] = [
    ":requirements",
    ":types",
    ":constants",
    ":predicates",
    ":functions",
    ":modules",
    ":action",
    ":durative-action",
    ":derived",
];
const PROBLEM_SECTIONS: [&str; 8] = [
    ":domain",
    ":objects",
    ":init",
    ":goal",
    ":metric",
    ":requirements",
    ":moduleoptions",
    ":moduleexitoptions",
];
const ACTION_KEYS: [&str; 3] = [":parameters", ":precondition", ":effect"];
const DURATIVE_KEYS: [&str; 4] = [":parameters", ":duration", ":condition", ":effect"];
const CONDITION_WORDS: [&str; 11] = [
    "and", "or", "not", "imply", "forall", "exists", "=", "<", "<=", ">", ">=",
];
const EFFECT_WORDS: [&str; 9] = [
    "and",
    "not",
    "forall",
    "when",
    "increase",
    "decrease",
    "assign",
    "scale-up",
    "scale-down",
];
const TIMES: [&str; 3] = ["at start", "over all", "at end"];

/// What can be written at byte `offset` of a file.
#[must_use]
pub fn completions(
    tree: &Tree,
    offset: u32,
    domain: Option<&Domain>,
    problem: Option<&Problem>,
) -> Vec<Completion> {
    let place = Place::new(tree, offset);
    let mut offer = Offer {
        domain,
        problem,
        found: Vec::new(),
    };
    match place.before {
        Before::Dash => offer.types(),
        Before::Bracket => offer.modules(),
        _ if place.section == ":requirements" => offer.words(supported_flags()),
        Before::Parenthesis if place.depth == 2 => offer.sections(&place.definition),
        Before::Parenthesis => offer.heads(&place),
        Before::Other if place.in_body() => offer.arguments(&place),
        Before::Other if place.depth == 2 && place.is_action() => {
            let durative = place.section == ":durative-action";
            offer.words(
                if durative {
                    &DURATIVE_KEYS[..]
                } else {
                    &ACTION_KEYS[..]
                }
                .iter()
                .copied(),
            );
        }
        Before::Other if place.section == ":domain" => {
            if let Some(domain) = domain {
                offer.symbol(SymbolKind::Domain, &domain.name.text, String::new());
            }
        }
        Before::Other => {}
    }
    offer.found
}

/// What stands before the word at the cursor.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Before {
    Parenthesis,
    Bracket,
    Dash,
    Other,
}

/// Where the cursor is.
struct Place {
    before: Before,
    /// Lists around the cursor.
    depth: usize,
    /// `domain` or `problem`.
    definition: String,
    /// Keyword of the section around the cursor.
    section: String,
    /// Key of the action before the cursor, `:effect`.
    key: String,
    /// Variables in scope.
    variables: Vec<String>,
}

fn lower_head(node: Node<'_>) -> String {
    node.head()
        .and_then(Node::word)
        .map_or_else(String::new, str::to_ascii_lowercase)
}

impl Place {
    fn new(tree: &Tree, offset: u32) -> Self {
        let path = tree.path_to(offset);
        // A list counts only if the cursor stands behind its opener.
        let lists: Vec<Node<'_>> = path
            .into_iter()
            .filter(|node| node.kind() != NodeKind::Word && node.span().start < offset)
            .collect();
        let definition = lists
            .first()
            .and_then(|root| root.children().nth(1))
            .map_or_else(String::new, lower_head);
        let section = lists.get(1).copied();
        let key = section.map_or_else(String::new, |section| {
            section
                .children()
                .take_while(|part| part.span().start < offset)
                .filter_map(Node::word)
                .filter(|word| word.starts_with(':'))
                .last()
                .map_or_else(String::new, str::to_ascii_lowercase)
        });
        Self {
            before: before(tree, offset),
            depth: lists.len(),
            definition,
            section: section.map_or_else(String::new, lower_head),
            key,
            variables: variables(&lists),
        }
    }

    fn is_action(&self) -> bool {
        matches!(self.section.as_str(), ":action" | ":durative-action")
    }

    /// Whether atoms can stand here.
    fn in_body(&self) -> bool {
        let value = matches!(
            self.key.as_str(),
            ":effect" | ":condition" | ":precondition" | ":duration"
        );
        matches!(
            self.section.as_str(),
            ":init" | ":goal" | ":metric" | ":derived"
        ) || (self.is_action() && value && self.depth > 2)
    }
}

fn before(tree: &Tree, offset: u32) -> Before {
    let tokens = tree.tokens();
    let mut token = tokens.starts.partition_point(|&start| start < offset);
    while token > 0 {
        token -= 1;
        let kind = tokens.kinds[token];
        let span = tokens.span(token);
        let touches = kind == TokenKind::Word && span.end >= offset;
        if touches || kind.is_trivia() {
            continue;
        }
        let text = &tree.text()[span.start as usize..span.end as usize];
        return match kind {
            TokenKind::LeftParenthesis => Before::Parenthesis,
            TokenKind::LeftBracket => Before::Bracket,
            _ if text == "-" => Before::Dash,
            _ => Before::Other,
        };
    }
    Before::Other
}

/// Variables of the action and the quantifiers around the cursor.
fn variables(lists: &[Node<'_>]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for list in lists {
        let head = lower_head(*list);
        let declaring = match head.as_str() {
            ":action" | ":durative-action" => list
                .children()
                .skip_while(|part| part.text() != ":parameters")
                .nth(1),
            "forall" | "exists" | ":derived" => list.children().nth(1),
            _ => None,
        };
        let words = declaring.into_iter().flat_map(Node::children);
        for word in words.filter_map(Node::word) {
            if word.starts_with('?') && !found.iter().any(|known| known == word) {
                found.push(word.to_owned());
            }
        }
    }
    found
}

struct Offer<'m> {
    domain: Option<&'m Domain>,
    problem: Option<&'m Problem>,
    found: Vec<Completion>,
}

impl Offer<'_> {
    fn symbol(&mut self, kind: SymbolKind, text: &str, detail: String) {
        self.found.push(Completion {
            text: text.to_owned(),
            kind: Some(kind),
            detail,
        });
    }

    fn words<'w>(&mut self, words: impl Iterator<Item = &'w str>) {
        self.found.extend(words.map(|word| Completion {
            text: word.to_owned(),
            kind: None,
            detail: String::new(),
        }));
    }

    fn sections(&mut self, definition: &str) {
        if definition == "problem" {
            self.words(PROBLEM_SECTIONS.into_iter());
        } else {
            self.words(DOMAIN_SECTIONS.into_iter());
        }
    }

    fn types(&mut self) {
        let Some(domain) = self.domain else { return };
        for declared in &domain.types {
            let parents: Vec<&str> = declared
                .parents
                .iter()
                .map(|parent| domain.types[parent.index()].name.text.as_str())
                .collect();
            let detail = if parents.is_empty() {
                String::new()
            } else {
                format!("- {}", parents.join(" "))
            };
            self.symbol(SymbolKind::Type, &declared.name.text, detail);
        }
    }

    fn modules(&mut self) {
        let Some(domain) = self.domain else { return };
        for module in &domain.modules {
            let detail = signature(domain, &module.name.text, &module.parameters);
            self.symbol(SymbolKind::Module, &module.name.text, detail);
        }
    }

    /// Behind an opening parenthesis of a body.
    fn heads(&mut self, place: &Place) {
        if let Some(domain) = self.domain {
            for predicate in &domain.predicates {
                let detail = signature(domain, &predicate.name.text, &predicate.parameters);
                self.symbol(SymbolKind::Predicate, &predicate.name.text, detail);
            }
            for function in &domain.functions {
                let detail = signature(domain, &function.name.text, &function.parameters);
                self.symbol(SymbolKind::Function, &function.name.text, detail);
            }
        }
        if place.section == ":durative-action" && place.key != ":duration" {
            self.words(TIMES.into_iter());
        }
        match (place.section.as_str(), place.key.as_str()) {
            (":init", _) => self.words(["=", "at", "not"].into_iter()),
            (_, ":effect") => self.words(EFFECT_WORDS.into_iter()),
            (_, ":duration") => self.words(["=", "<=", ">=", "and"].into_iter()),
            _ => self.words(CONDITION_WORDS.into_iter()),
        }
    }

    /// Behind the head of an atom.
    fn arguments(&mut self, place: &Place) {
        for variable in &place.variables {
            self.symbol(SymbolKind::Variable, variable, String::new());
        }
        let Some(domain) = self.domain else { return };
        let objects = self
            .problem
            .map_or(&domain.constants, |problem| &problem.objects);
        for object in objects {
            let types: Vec<&str> = object
                .types
                .iter()
                .map(|kind| domain.types[kind.index()].name.text.as_str())
                .collect();
            self.symbol(
                SymbolKind::Object,
                &object.name.text,
                format!("- {}", types.join(" ")),
            );
        }
    }
}

fn signature(domain: &Domain, name: &str, parameters: &[Parameter]) -> String {
    format!("({name}{})", parameter_list(domain, parameters))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pddl::read_domain;
    use crate::syntax::source::SourceFile;

    /// Texts offered at the `|` of a domain.
    fn offered(marked: &str) -> Vec<String> {
        let offset = marked.find('|').unwrap();
        let text = marked.replace('|', "");
        let source = SourceFile::new("d.pddl", text);
        let (domain, _) = read_domain(&source);
        completions(&Tree::new(&source), offset as u32, domain.as_ref(), None)
            .into_iter()
            .map(|completion| completion.text)
            .collect()
    }

    #[test]
    fn each_place_has_its_own_words() {
        let domain = "(define (domain d) (:requirements :ty|) (:types robot place)
            (:constants home - place) (:predicates (at ?r - robot ?p - place)) (:modules (cost ?r - robot cost c@w))
            (:durative-action go :parameters (?r - robot) :duration (= ?duration [)
              :condition (at start (at ?r )) :effect ( ))";
        assert!(offered(domain).contains(&":typing".to_owned()));
        let at = |place: &str, more: &str| {
            let plain = domain.replace('|', "");
            let end = plain.find(place).unwrap() + place.len();
            format!("{}{more}|{}", &plain[..end], &plain[end..])
        };
        assert_eq!(offered(&at("(?r - ", "")), ["object", "robot", "place"]);
        assert_eq!(offered(&at("?duration [", "")), ["cost"]);
        assert_eq!(offered(&at("(at start (at ?r ", "")), ["?r", "home"]);
        assert_eq!(offered(&at("(at start (at ?r ", "ho")), ["?r", "home"]);
        let effects = offered(&at(":effect (", ""));
        assert!(effects.contains(&"at".to_owned()) && effects.contains(&"increase".to_owned()));
        assert!(offered("(define (domain d) (|)").contains(&":action".to_owned()));
        assert!(offered("(define (domain d) (:action a |)").contains(&":effect".to_owned()));
        assert!(offered("|").is_empty());
    }
}
