//! Arguments of predicates, functions and modules: number and types.

use super::names::lower;
use super::scope::Reader;
use super::types::{Fit, display};
use crate::pddl::model::{
    Atom, FluentTerm, FunctionId, ModuleCall, ModuleKind, Name, ObjectId, Parameter, PredicateId,
    Term, TypeId,
};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::span::Span;
use crate::syntax::suggestion::nearest;
use crate::syntax::tree::Node;

impl<'d> Reader<'d> {
    /// `(p t ...)`.
    pub fn atom(&mut self, node: Node<'_>) -> Option<Atom> {
        let head = node.head()?;
        let predicate = self.predicate(head)?;
        let declaration = &self.domain.predicates[predicate.index()];
        let arguments = self.arguments(
            node,
            node.children().skip(1),
            &declaration.parameters,
            &declaration.name,
        )?;
        Some(Atom {
            predicate,
            arguments,
            span: node.span(),
        })
    }

    /// Resolves the name of a predicate.
    pub fn predicate(&mut self, head: Node<'_>) -> Option<PredicateId> {
        let word = head.text();
        let name = lower(word);
        if let Some(&predicate) = self.names.predicates.get(name.as_ref()) {
            return Some(predicate);
        }
        if self.names.functions.contains_key(name.as_ref()) {
            self.sink.push(
                Diagnostic::new(
                    Code::KindMismatch,
                    head.span(),
                    format!("`{word}` is a numeric function, not a predicate"),
                )
                .label("a number, neither true nor false")
                .remedy(format!("compare it, as in `(>= ({word} ...) 1)`")),
            );
            return None;
        }
        if self.names.modules.contains_key(name.as_ref()) {
            self.sink.push(
                Diagnostic::new(
                    Code::KindMismatch,
                    head.span(),
                    format!("`{word}` is a module, not a predicate"),
                )
                .label("called in square brackets")
                .remedy(format!("write `([{word} ...])`")),
            );
            return None;
        }
        let known = self.domain.predicates.iter();
        self.sink.report(Code::UnknownPredicate, || {
            let suggestion = nearest(&name, known.map(|predicate| predicate.name.text.as_str()));
            let diagnostic = Diagnostic::new(
                Code::UnknownPredicate,
                head.span(),
                format!("unknown predicate `{word}`"),
            )
            .label("not declared in (:predicates ...)");
            match suggestion {
                Some(_) => diagnostic.did_you_mean(suggestion),
                None => diagnostic.remedy(format!("declare `{word}` in (:predicates ...)")),
            }
        });
        None
    }

    /// `(f t ...)`, or `f` alone.
    pub fn fluent(&mut self, node: Node<'_>) -> Option<FluentTerm> {
        let head = if node.word().is_some() {
            node
        } else {
            node.head().filter(|head| head.word().is_some())?
        };
        let function = self.function(head)?;
        let declaration = &self.domain.functions[function.index()];
        let arguments = self.arguments(
            node,
            node.children().skip(1),
            &declaration.parameters,
            &declaration.name,
        )?;
        Some(FluentTerm {
            function,
            arguments,
            span: node.span(),
        })
    }

    /// Resolves the name of a function.
    pub fn function(&mut self, head: Node<'_>) -> Option<FunctionId> {
        let word = head.text();
        let name = lower(word);
        if let Some(&function) = self.names.functions.get(name.as_ref()) {
            return Some(function);
        }
        if self.names.predicates.contains_key(name.as_ref()) {
            self.sink.push(
                Diagnostic::new(
                    Code::KindMismatch,
                    head.span(),
                    format!("`{word}` is a predicate, not a numeric function"),
                )
                .label("has no numeric value"),
            );
            return None;
        }
        let known = self.domain.functions.iter();
        self.sink.report(Code::UnknownFunction, || {
            let suggestion = nearest(&name, known.map(|function| function.name.text.as_str()));
            let diagnostic = Diagnostic::new(
                Code::UnknownFunction,
                head.span(),
                format!("unknown function `{word}`"),
            )
            .label("not declared in (:functions ...)");
            match suggestion {
                Some(_) => diagnostic.did_you_mean(suggestion),
                None => diagnostic.remedy(format!("declare `({word} ...)` in (:functions ...)")),
            }
        });
        None
    }

    /// `[m t ...]` of a module of the given kind.
    pub fn module_call(&mut self, node: Node<'_>, kind: ModuleKind) -> Option<ModuleCall> {
        let Some(head) = node.head().filter(|head| head.word().is_some()) else {
            self.sink
                .expected(node.span(), "a call such as `[module ?x]`", Some(node));
            return None;
        };
        let name = lower(head.text());
        let Some(&module) = self.names.modules.get(name.as_ref()) else {
            let known = self.domain.modules.iter();
            let suggestion = nearest(&name, known.map(|module| module.name.text.as_str()));
            let diagnostic = Diagnostic::new(
                Code::UnknownModule,
                head.span(),
                format!("unknown module `{}`", head.text()),
            )
            .label("not declared in (:modules ...)");
            self.sink.push(match suggestion {
                Some(_) => diagnostic.did_you_mean(suggestion),
                None => diagnostic.remedy(format!(
                    "declare it: `(:modules ({} ?x - type {} function@provider))`",
                    head.text(),
                    keyword(kind)
                )),
            });
            return None;
        };
        let declaration = &self.domain.modules[module.index()];
        if declaration.kind != kind {
            self.sink.push(
                Diagnostic::new(
                    Code::WrongModuleKind,
                    node.span(),
                    format!(
                        "module `{}` is of kind `{}`, `{}` is needed here",
                        head.text(),
                        keyword(declaration.kind),
                        keyword(kind)
                    ),
                )
                .label(match kind {
                    ModuleKind::Cost => "a number is needed here",
                    ModuleKind::Condition => "a truth value is needed here",
                    ModuleKind::Effect => "new values of fluents are needed here",
                })
                .note_at(self.domain_place, declaration.name.span, "declared here"),
            );
            return None;
        }
        let arguments = self.arguments(
            node,
            node.children().skip(1),
            &declaration.parameters,
            &declaration.name,
        )?;
        Some(ModuleCall {
            module,
            arguments,
            span: node.span(),
        })
    }

    /// Arguments against the parameters of a declaration.
    fn arguments<'t>(
        &mut self,
        whole: Node<'_>,
        nodes: impl Iterator<Item = Node<'t>>,
        parameters: &'d [Parameter],
        declared: &'d Name,
    ) -> Option<Vec<Term>> {
        let mut terms = Vec::with_capacity(parameters.len());
        let mut complete = true;
        let mut count = 0;
        for node in nodes {
            let parameter = parameters.get(count);
            count += 1;
            match self.term(node) {
                Some(term) => {
                    terms.push(term);
                    if let Some(parameter) = parameter {
                        complete &= self.check_type(node, term, parameter, declared);
                    }
                }
                None => complete = false,
            }
        }
        if count != parameters.len() {
            self.wrong_arity(whole.span(), count, parameters.len(), declared);
            return None;
        }
        complete.then_some(terms)
    }

    pub fn wrong_arity(&mut self, span: Span, count: usize, wanted: usize, declared: &Name) {
        let plural = if wanted == 1 { "" } else { "s" };
        self.sink.push(
            Diagnostic::new(
                Code::WrongArity,
                span,
                format!(
                    "`{}` takes {wanted} argument{plural}, here it has {count}",
                    declared.text
                ),
            )
            .label(format!("{count} given"))
            .note_at(
                self.domain_place,
                declared.span,
                format!("declared with {wanted}"),
            )
            .remedy(if count < wanted {
                format!("add {}", count_of(wanted - count))
            } else {
                format!("remove {}", count_of(count - wanted))
            }),
        );
    }

    /// Whether a term can be of its parameter's type; a variable of a wider type gets a warning.
    fn check_type(
        &mut self,
        node: Node<'_>,
        term: Term,
        parameter: &Parameter,
        declared: &Name,
    ) -> bool {
        let (objects, variables) = (self.objects, &self.variables);
        let given: &[TypeId] = match term {
            Term::Object(object) => &objects[object.index()].types,
            Term::Variable(variable) => &variables[variable.index()].types,
        };
        if given == parameter.types.as_slice() {
            return true;
        }
        let fit = self.hierarchy.fit(given, &parameter.types);
        if fit == Fit::All
            || (fit == Fit::Some && matches!(term, Term::Object(_)) && given.len() > 1)
        {
            return true;
        }
        let types = &self.domain.types;
        let (given, wanted) = (display(given, types), display(&parameter.types, types));
        let message = format!(
            "`{}` is of type `{given}`, `{}` wants `{wanted}` here",
            node.text(),
            declared.text
        );
        let note = format!("`{}` is declared as `{wanted}`", parameter.name.text);
        let wider = fit == Fit::Some && matches!(term, Term::Variable(_));
        let (code, label, remedy) = if wider {
            (
                Code::WiderType,
                "only some of its objects fit",
                format!("narrow the type of `{}` to `{wanted}`", node.text()),
            )
        } else {
            (
                Code::TypeMismatch,
                "of a type that does not fit",
                format!("use something of type `{wanted}`, or widen the declaration"),
            )
        };
        self.sink.push(
            Diagnostic::new(code, node.span(), message)
                .label(label)
                .note_at(self.domain_place, parameter.name.span, note)
                .remedy(remedy),
        );
        wider
    }

    /// [`Self::check_type`] for the arguments of initial facts; quick where types are equal.
    pub fn check_object(
        &mut self,
        node: Node<'_>,
        object: ObjectId,
        parameter: &Parameter,
        declared: &Name,
    ) -> bool {
        self.objects[object.index()].types == parameter.types
            || parameter.types[0] == super::types::OBJECT
            || self.check_type(node, Term::Object(object), parameter, declared)
    }
}

/// The word of a kind in `(:modules ...)`.
pub(super) const fn keyword(kind: ModuleKind) -> &'static str {
    match kind {
        ModuleKind::Cost => "cost",
        ModuleKind::Condition => "conditionchecker",
        ModuleKind::Effect => "effect",
    }
}

fn count_of(count: usize) -> String {
    match count {
        1 => "one argument".to_owned(),
        several => format!("{several} arguments"),
    }
}
