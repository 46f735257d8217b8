//! Modules that no attachment computes.

use super::Subject;
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};
use crate::syntax::suggestion::nearest;

/// Reports them, if the providers are known.
pub(super) fn check(subject: &Subject<'_>, found: &mut Diagnostics) {
    let Some(providers) = subject.providers else {
        return;
    };
    for module in &subject.domain.modules {
        let name = &module.name;
        if providers
            .iter()
            .any(|provider| provider.eq_ignore_ascii_case(&name.text))
        {
            continue;
        }
        let known = providers.iter().map(String::as_str);
        let remedy = match nearest(&name.text, known) {
            Some(near) => format!("did you mean `{near}`?"),
            None if providers.is_empty() => "no attachment is installed".to_owned(),
            None => format!("installed attachments: {}", providers.join(", ")),
        };
        found.push(
            Diagnostic::new(
                Code::MissingProvider,
                name.span,
                format!("no attachment is called `{}`", name.text),
            )
            .label("nobody computes this module")
            .note(module.call.span, "the provider that the domain names")
            .remedy(remedy),
        );
    }
}
