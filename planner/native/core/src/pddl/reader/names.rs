//! Name tables: lower-cased text to id.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use crate::pddl::model::{
    Domain, FunctionId, ModuleId, Name, ObjectDeclaration, ObjectId, PredicateId, TypeId,
};
use crate::syntax::tree::Node;

/// Names are compared without regard to ASCII case.
pub(super) fn lower(text: &str) -> Cow<'_, str> {
    if text.bytes().any(|byte| byte.is_ascii_uppercase()) {
        Cow::Owned(text.to_ascii_lowercase())
    } else {
        Cow::Borrowed(text)
    }
}

/// The name that a word is.
pub(super) fn name(node: Node<'_>) -> Name {
    Name {
        text: lower(node.text()).into_owned(),
        span: node.span(),
    }
}

/// A name whose case is kept: calls of providers and their options.
pub(super) fn verbatim(node: Node<'_>) -> Name {
    Name {
        text: node.text().to_owned(),
        span: node.span(),
    }
}

/// Tables of everything that can be named.
#[derive(Default)]
pub(super) struct Names {
    pub types: FxHashMap<String, TypeId>,
    pub predicates: FxHashMap<String, PredicateId>,
    pub functions: FxHashMap<String, FunctionId>,
    pub modules: FxHashMap<String, ModuleId>,
    pub objects: FxHashMap<String, ObjectId>,
}

impl Names {
    /// The tables of a domain, its constants as objects.
    pub fn of(domain: &Domain) -> Self {
        let mut names = Self::default();
        for (index, declaration) in domain.types.iter().enumerate() {
            names
                .types
                .insert(declaration.name.text.clone(), TypeId(index as u32));
        }
        for (index, declaration) in domain.predicates.iter().enumerate() {
            let id = PredicateId(index as u32);
            names.predicates.insert(declaration.name.text.clone(), id);
        }
        for (index, declaration) in domain.functions.iter().enumerate() {
            let id = FunctionId(index as u32);
            names.functions.insert(declaration.name.text.clone(), id);
        }
        for (index, declaration) in domain.modules.iter().enumerate() {
            names
                .modules
                .insert(declaration.name.text.clone(), ModuleId(index as u32));
        }
        names.add_objects(&domain.constants, 0);
        names
    }

    /// Adds objects, the first of which has the id `first`.
    pub fn add_objects(&mut self, objects: &[ObjectDeclaration], first: u32) {
        self.objects.reserve(objects.len());
        for (id, object) in (first..).zip(objects) {
            self.objects.insert(object.name.text.clone(), ObjectId(id));
        }
    }
}
