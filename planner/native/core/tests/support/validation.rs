//! Plans that the validator must accept or reject.

#![allow(dead_code)] // each test takes what it needs

use planner_core::attachment::{Attachments, NoAttachments};
use planner_core::pddl::model::{Domain, Problem};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::reader;
use planner_core::syntax::diagnostic::has_errors;
use planner_core::syntax::render::render_all;
use planner_core::syntax::source::SourceFile;
use planner_core::validate::{Options, Verdict, validate};

/// A domain and a problem whose plans are judged.
pub struct Case {
    /// The domain.
    pub domain: Domain,
    /// The problem.
    pub problem: Problem,
}

/// Reads both texts.
pub fn case(domain: &str, problem: &str) -> Case {
    let domain_source = SourceFile::new("d.pddl", domain);
    let (domain, diagnostics) = read_domain(&domain_source);
    assert!(
        !has_errors(&diagnostics),
        "{}",
        render_all(&diagnostics, &domain_source, None)
    );
    let domain = domain.unwrap();
    let source = SourceFile::new("p.pddl", problem);
    let (problem, diagnostics) = read_problem(&source, &domain);
    assert!(
        !has_errors(&diagnostics),
        "{}",
        render_all(&diagnostics, &source, Some(&domain_source))
    );
    Case {
        domain,
        problem: problem.unwrap(),
    }
}

impl Case {
    /// The verdict on a plan.
    pub fn verdict_with(
        &self,
        plan: &str,
        options: &Options,
        attachments: &dyn Attachments,
    ) -> Verdict {
        let source = SourceFile::new("plan", plan);
        let (plan, diagnostics) = reader::read(&source, &self.domain, &self.problem);
        let plan = plan.unwrap_or_else(|| panic!("{}", render_all(&diagnostics, &source, None)));
        validate(&self.domain, &self.problem, &plan, attachments, options)
    }

    /// The verdict without attachments.
    pub fn verdict(&self, plan: &str) -> Verdict {
        self.verdict_with(plan, &Options::default(), &NoAttachments)
    }

    /// Why the plan is rejected: the code and the message.
    pub fn rejected(&self, plan: &str) -> (&'static str, String) {
        let failure = self
            .verdict(plan)
            .failure
            .expect("the plan must be rejected");
        (failure.reason.code(), failure.to_string())
    }

    /// The verdict on a plan that must be valid.
    pub fn accepted(&self, plan: &str) -> Verdict {
        let verdict = self.verdict(plan);
        assert_eq!(
            verdict.failure.as_ref().map(ToString::to_string),
            None,
            "the plan must be accepted"
        );
        verdict
    }
}
