//! "Did you mean ...?": the nearest of the words that are allowed.

/// The one of `words` that `found` was probably meant to be.
pub fn did_you_mean<'w>(found: &str, words: &[&'w str]) -> Option<&'w str> {
    let found: Vec<char> = found.chars().take(64).flat_map(char::to_lowercase).collect();
    // One slip in a short word, two from six letters on, three from nine on; of two letters one must be right, and in front.
    let allowed = (found.len() / 3).max(1);
    let likely = |word: &Vec<char>| {
        let d = distance(&found, word);
        let swapped = || found.iter().rev().eq(word);
        let near = d <= allowed && d < word.len() && (found.len() > 2 || found.first() == word.first() || swapped());
        (d == 0 || near).then_some(d)
    };
    let ranked = words.iter().filter_map(|word| Some((likely(&word.to_lowercase().chars().collect())?, *word)));
    // Of two words as near, the one with the same letters.
    let letters = |word: &str| {
        let mut letters: Vec<char> = word.to_lowercase().chars().collect();
        letters.sort_unstable();
        letters
    };
    let own = letters(&found.iter().collect::<String>());
    ranked.min_by_key(|(d, word)| (*d, letters(word) != own)).map(|(_, word)| word)
}

/// Least number of letters to insert, remove, replace or swap with their neighbour.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::did_you_mean;

    #[track_caller]
    fn check(found: &str, meant: Option<&str>) {
        let words = ["mass", "com", "inertia", "xy", "standard", "modified", "regressor"];
        assert_eq!(did_you_mean(found, &words), meant);
    }

    #[test]
    fn slips_are_recognised_and_other_words_are_not() {
        check("masss", Some("mass"));
        check("Mass", Some("mass"));
        check("yx", Some("xy"));
        assert_eq!(did_you_mean("yx", &["yz", "xy"]), Some("xy"), "the same letters are nearer");
        check("xx", Some("xy"));
        check("ay", None);
        check("intertia", Some("inertia"));
        check("regresor", Some("regressor"));
        check("STANDARD", Some("standard"));
        check("zz", None);
        check("weight", None);
        check("", None);
    }
}
