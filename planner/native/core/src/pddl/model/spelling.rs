//! Names as their author wrote them, for people; the reader lower-cases them, because case does not
//! tell names apart.

use super::{Domain, Name, Problem};
use crate::syntax::source::SourceFile;

fn spell(name: &mut Name, file: &SourceFile) {
    // The name of the root type stands nowhere.
    let Some(written) = file
        .text()
        .get(name.span.start as usize..name.span.end as usize)
    else {
        return;
    };
    if written.eq_ignore_ascii_case(&name.text) {
        written.clone_into(&mut name.text);
    }
}

impl Domain {
    /// Gives declared names the spelling that they have in the file that the domain was read from.
    /// The model is for showing then; lower-cased names no longer find them.
    pub fn spell_as_in(&mut self, file: &SourceFile) {
        spell(&mut self.name, file);
        let declared = (self.types.iter_mut().map(|one| &mut one.name))
            .chain(self.constants.iter_mut().map(|one| &mut one.name))
            .chain(self.predicates.iter_mut().map(|one| &mut one.name))
            .chain(self.functions.iter_mut().map(|one| &mut one.name))
            .chain(self.modules.iter_mut().map(|one| &mut one.name))
            .chain(self.actions.iter_mut().map(|one| &mut one.name));
        declared.for_each(|name| spell(name, file));
        let parameters = (self
            .predicates
            .iter_mut()
            .flat_map(|one| &mut one.parameters))
        .chain(
            self.functions
                .iter_mut()
                .flat_map(|one| &mut one.parameters),
        )
        .chain(self.modules.iter_mut().flat_map(|one| &mut one.parameters));
        parameters.for_each(|parameter| spell(&mut parameter.name, file));
    }
}

impl Problem {
    /// The same for a problem; its constants are spelt as its domain spells them.
    pub fn spell_as_in(&mut self, file: &SourceFile, domain: &Domain) {
        spell(&mut self.name, file);
        for (index, object) in self.objects.iter_mut().enumerate() {
            match domain.constants.get(index) {
                Some(constant) => object.name.text.clone_from(&constant.name.text),
                None => spell(&mut object.name, file),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::pddl::{read_domain, read_problem};
    use crate::syntax::source::SourceFile;

    #[test]
    fn names_are_spelt_as_declared_not_as_used() {
        let domain_file = SourceFile::new(
            "d.pddl",
            "(define (domain D) (:requirements :typing) (:types Robot) (:constants R1 - ROBOT)
               (:predicates (isFree ?theRobot - robot)) (:modules (pathCost ?R - robot cost c@w)))",
        );
        let problem_file = SourceFile::new(
            "p.pddl",
            "(define (problem P) (:domain d) (:objects R2 - robot) (:init (ISFREE r1)) (:goal (isfree r2)))",
        );
        let mut domain = read_domain(&domain_file).0.unwrap();
        let mut problem = read_problem(&problem_file, &domain).0.unwrap();
        domain.spell_as_in(&domain_file);
        problem.spell_as_in(&problem_file, &domain);
        assert_eq!(domain.types[0].name.text, "object");
        assert_eq!(domain.types[1].name.text, "Robot");
        assert_eq!(domain.predicates[0].name.text, "isFree");
        assert_eq!(domain.predicates[0].parameters[0].name.text, "?theRobot");
        assert_eq!(domain.modules[0].name.text, "pathCost");
        let objects = problem.objects.iter().map(|one| one.name.text.as_str());
        assert_eq!(objects.collect::<Vec<_>>(), ["R1", "R2"]);
    }
}
