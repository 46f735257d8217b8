//! Identifiers: positions in the tables of the model.

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);
        impl $name {
            /// Position in the table that this id points into.
            #[must_use]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

ids! {
    /// Index into [`super::Domain::types`]; 0 is `object`.
    TypeId,
    /// Index into [`super::Domain::predicates`].
    PredicateId,
    /// Index into [`super::Domain::functions`].
    FunctionId,
    /// Index into [`super::Domain::modules`].
    ModuleId,
    /// Index into [`super::Problem::objects`]; the domain's constants come first, in the same order.
    ObjectId,
    /// Index into [`super::Domain::actions`].
    ActionId,
    /// Position in the stack of bound variables.
    VariableId,
}
