//! The happenings of a plan: points in time at which something starts, ends or occurs.

/// What occurs at a point in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occurrence {
    /// A durative action starts, or an instantaneous one happens: position in the plan's steps.
    Start(usize),
    /// A durative action ends: position in the plan's steps.
    End(usize),
    /// A timed initial literal: position in the problem's list.
    Timed(usize),
}

/// Everything that occurs at one moment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Happening {
    /// Its time: that of the earliest occurrence in it [s].
    pub(super) time: f64,
    /// What occurs; each entry is one actor of the mutex check.
    pub(super) occurrences: Vec<Occurrence>,
}

/// Groups occurrences into happenings as VAL does: sorted by time, one happening takes everything
/// up to `together_s` after its first member, a tenth of the tolerance there.
///
/// Source: Howey, Long, Fox, "VAL: automatic plan validation, continuous effects and mixed
/// initiative planning using PDDL", ICTAI 2004, and the behaviour of its implementation.
pub(super) fn happenings(
    mut occurrences: Vec<(f64, Occurrence)>,
    together_s: f64,
) -> Vec<Happening> {
    occurrences.sort_by(|left, right| left.0.total_cmp(&right.0));
    let mut happenings: Vec<Happening> = Vec::new();
    for (time, occurrence) in occurrences {
        match happenings.last_mut() {
            Some(last) if time <= last.time + together_s => {
                last.occurrences.push(occurrence);
            }
            _ => happenings.push(Happening {
                time,
                occurrences: vec![occurrence],
            }),
        }
    }
    happenings
}

#[cfg(test)]
mod tests {
    use super::{Occurrence, happenings};

    #[test]
    fn what_is_near_the_first_is_one_happening() {
        let times = [0.0, 0.000_05, 0.000_1, 0.000_2, 5.0];
        let grouped = happenings(
            times
                .iter()
                .enumerate()
                .map(|(index, time)| (*time, Occurrence::Start(index)))
                .collect(),
            0.000_1,
        );
        let sizes: Vec<_> = grouped.iter().map(|one| one.occurrences.len()).collect();
        assert_eq!(sizes, [3, 1, 1]);
    }

    #[test]
    fn occurrences_at_one_time_keep_their_order() {
        let grouped = happenings(
            vec![
                (1.0, Occurrence::End(0)),
                (0.0, Occurrence::Start(0)),
                (1.0, Occurrence::Start(1)),
            ],
            0.000_1,
        );
        assert_eq!(
            grouped[1].occurrences,
            [Occurrence::End(0), Occurrence::Start(1)]
        );
    }
}
