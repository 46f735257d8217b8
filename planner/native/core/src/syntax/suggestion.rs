//! "Did you mean ...?": the nearest known name.

/// Candidates looked at, so that a huge file with many faults is still read at once.
const EXAMINED: usize = 10_000;

/// The candidate with the smallest edit distance to `written`, if one is near enough to be meant;
/// of equally near ones the first. Distance counts insertions, deletions, substitutions and
/// swaps of neighbours (optimal string alignment).
pub fn nearest<'c>(
    written: &str,
    candidates: impl IntoIterator<Item = &'c str>,
) -> Option<&'c str> {
    let length = written.chars().count();
    if length > 64 {
        return None;
    }
    let limit = (length / 3).max(1);
    let letters: Vec<char> = letters(written).collect();
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates.into_iter().take(EXAMINED) {
        if candidate.len().abs_diff(written.len()) > 4 * limit || candidate == written {
            continue;
        }
        let distance = if self::letters(candidate).eq(letters.iter().copied()) {
            0
        } else {
            edit_distance(written, candidate)
        };
        if distance <= limit && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// Lower-case letters and digits only: `Path_Cost` and `path-cost` are the same word.
fn letters(word: &str) -> impl Iterator<Item = char> {
    word.chars()
        .filter(|character| character.is_alphanumeric())
        .flat_map(char::to_lowercase)
}

fn edit_distance(left: &str, right: &str) -> usize {
    let left: Vec<char> = left.chars().collect();
    let right: Vec<char> = right.chars().collect();
    let mut before_last = vec![0; right.len() + 1];
    let mut last: Vec<usize> = (0..=right.len()).collect();
    for (i, &a) in left.iter().enumerate() {
        let mut row = vec![i + 1; right.len() + 1];
        for (j, &b) in right.iter().enumerate() {
            row[j + 1] = (last[j] + usize::from(a != b))
                .min(last[j + 1] + 1)
                .min(row[j] + 1);
            if i > 0 && j > 0 && a == right[j - 1] && left[i - 1] == b {
                row[j + 1] = row[j + 1].min(before_last[j - 1] + 1);
            }
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[right.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("cleared", "claered"), 1);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }

    #[test]
    fn the_nearest_name_wins_and_far_ones_are_not_offered() {
        let names = ["cleared", "explored", "at"];
        assert_eq!(nearest("claered", names), Some("cleared"));
        assert_eq!(nearest("docked", names), None);
        assert_eq!(nearest("pathcost", ["path-cost"]), Some("path-cost"));
        assert_eq!(nearest("x", []), None);
    }
}
