//! The cause of a syntax error: the parser often stops later than the slip, or reports a missing character instead of the slip.

use serde_yaml::granit_parser::ErrorKind;

use super::explain;
use crate::source::Span;

/// The likely cause of a parse error.
pub(super) struct Cause {
    pub(super) span: Span,
    pub(super) message: String,
    pub(super) help: String,
}

impl Cause {
    fn of(span: Span, kind: &ErrorKind) -> Cause {
        let (message, help) = explain(kind);
        Cause { span, message, help }
    }
}

/// A quoted text over several lines whose closing quote comes before `at` in its line. That quote was meant to open another text:
/// the closing quote is missing in the first line.
pub(super) fn unclosed_quote(text: &str, at: usize) -> Option<Cause> {
    let before = text.get(..at)?;
    let line = before.rfind('\n').map_or(0, |end| end + 1);
    let opened = opened_quote(&before[..line])?;
    Some(Cause::of(Span::new(opened, opened + 1), &ErrorKind::UnclosedQuotedScalar))
}

/// The likely cause of a parse error that surfaced at `at`, if this function finds it. Causes are an open quote above, and a tab in the
/// indentation of this or a neighbouring line. Others are a dash or a colon without a space, a missing dash, a line in a column of
/// its own, and a key without a colon.
pub(super) fn find(text: &str, at: usize, kind: &ErrorKind) -> Option<Cause> {
    use ErrorKind as E;
    match kind {
        E::InvalidQuotedScalarIndent | E::UnclosedQuotedScalar | E::DocumentIndicatorInQuotedScalar => {
            let opened = opened_quote(text.get(..at)?)?;
            Some(Cause::of(Span::new(opened, opened + 1), &E::UnclosedQuotedScalar))
        }
        E::MappingValueNotAllowed
        | E::InvalidIndentation
        | E::ExpectedDocumentStart
        | E::ExpectedBlockMappingKey
        | E::ExpectedBlockSequenceEntry
        | E::SimpleKeyExpected
        | E::InvalidSimpleKey
        | E::MappingKeyNotAllowed
        | E::InvalidColonPlacement
        | E::BlockSequenceEntryNotAllowed => {
            let lines = lines(text);
            let here = lines.partition_point(|(start, _)| *start <= at).checked_sub(1)?;
            let without_colon = || matches!(kind, E::MappingValueNotAllowed).then(|| key_without_colon(text, at)).flatten();
            tab_beside(text, at)
                .or_else(|| invisible_beside(&lines, here))
                .or_else(|| without_space(&lines, here))
                .or_else(|| missing_dash(&lines, here))
                .or_else(|| own_column(&lines, here))
                .or_else(without_colon)
        }
        E::TabNotAllowed | E::TabInBlockIndentation | E::TabInIndentation | E::TabInPlainScalar => tab_beside(text, at),
        _ => None,
    }
}

/// Number of blanks that a line begins with.
fn indentation(line: &str) -> usize {
    line.len() - line.trim_start_matches(' ').len()
}

/// Whether a line has text other than a comment.
fn has_content(line: &str) -> bool {
    !line.trim_start().is_empty() && !line.trim_start().starts_with('#')
}

/// The nearest lines with content above and below.
fn above(lines: &[(usize, &str)], here: usize) -> Option<usize> {
    (0..here).rev().find(|i| has_content(lines[*i].1))
}

fn below(lines: &[(usize, &str)], here: usize) -> Option<usize> {
    (here + 1..lines.len()).find(|i| has_content(lines[*i].1))
}

fn begins_with_dash(line: &str) -> bool {
    matches!(line.trim_start_matches(' ').strip_prefix('-'), Some(rest) if rest.is_empty() || rest.starts_with(' '))
}

/// The column of a line's key: after the dash, if the line has a dash.
fn key_column(line: &str) -> usize {
    let rest = line.trim_start_matches(' ');
    let after = if begins_with_dash(line) { rest[1..].trim_start() } else { rest };
    line.len() - after.len()
}

/// Whether a text is like a key.
pub(super) fn is_word(word: &str) -> bool {
    word.starts_with(char::is_alphabetic) && word.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// `-name: x` or `name:x` in the line or above it.
fn without_space(lines: &[(usize, &str)], here: usize) -> Option<Cause> {
    [Some(here), above(lines, here)].into_iter().flatten().find_map(|i| {
        let (start, line) = lines[i];
        let dash = start + indentation(line);
        let (word, rest) = line.trim_start_matches(' ').split_once(':')?;
        if word.strip_prefix('-').is_some_and(is_word) {
            return Some(Cause {
                span: Span::new(dash, dash + 1),
                message: "a dash must be followed by a space".to_owned(),
                help: format!("write `- {}:`", &word[1..]),
            });
        }
        let colon = start + line.find(':')?;
        let key = word.trim_start_matches(['-', ' ']);
        (is_word(key) && rest.starts_with(|c: char| !c.is_whitespace())).then(|| Cause {
            span: Span::new(colon, colon + 1),
            message: "a colon must be followed by a space".to_owned(),
            help: format!("write `{key}: {}`", super::super::excerpt(rest)),
        })
    })
}

/// An entry of a list whose dash is missing: the first, where the next one has it, or one in the column of the dashes above.
fn missing_dash(lines: &[(usize, &str)], here: usize) -> Option<Cause> {
    let cause = |i: usize| {
        let (start, line) = lines[i];
        let own = indentation(line);
        let (from, word) = (start + own, &line[own..]);
        let key = word.split(':').next().unwrap_or_default();
        Cause {
            span: Span::new(from, from + key.len()),
            message: format!("a dash is missing before `{}`", super::super::excerpt(key)),
            help: "begin each entry of a list with `- `, in the column of the other dashes".to_owned(),
        }
    };
    let line = lines[here].1;
    let column = indentation(line);
    if begins_with_dash(line) {
        let mut first = None;
        let mut i = here;
        while let Some(up) = above(lines, i).filter(|up| indentation(lines[*up].1) >= column) {
            // A list that has begun with a dash lacks none at its first entry.
            if begins_with_dash(lines[up].1) && indentation(lines[up].1) <= column + 1 {
                return None;
            }
            (first, i) = (Some(up), up);
        }
        return first.filter(|_| above(lines, i).is_some_and(|up| lines[up].1.ends_with(':'))).map(cause);
    }
    // A key in the column of dashes, below an entry of their list.
    let mut i = here;
    while let Some(up) = above(lines, i).filter(|up| indentation(lines[*up].1) >= column) {
        if begins_with_dash(lines[up].1) && indentation(lines[up].1) == column {
            return line.contains(':').then(|| cause(here));
        }
        i = up;
    }
    None
}

/// A line, here or beside, whose column no other has, or that stands between two lines of one column.
fn own_column(lines: &[(usize, &str)], here: usize) -> Option<Cause> {
    let dashed = |i: usize| begins_with_dash(lines[i].1);
    let column = |i: usize| indentation(lines[i].1);
    // Columns of dashes and of keys are counted apart.
    let in_column = |dash: bool, c: usize| {
        let same = |i: &usize| {
            has_content(lines[*i].1) && if dash { dashed(*i) && column(*i) == c } else { key_column(lines[*i].1) == c }
        };
        (0..lines.len()).filter(same).count()
    };
    let beside = |i: usize| [below(lines, i), above(lines, i)].into_iter().flatten();
    // The columns of what stands beside; of a dash, those of the other dashes.
    let others = |i: usize| -> Vec<usize> {
        match dashed(i) {
            true => (0..lines.len()).filter(|j| *j != i && has_content(lines[*j].1) && dashed(*j)).map(column).collect(),
            false => beside(i).map(|j| key_column(lines[j].1)).collect(),
        }
    };
    let cause = |i: usize, fits: usize| {
        let (start, line) = lines[i];
        // Other white space than spaces is no indentation.
        let own = column(i);
        let word = &line[own..];
        let columns = |n: usize| format!("{n} column{}", if n == 1 { "" } else { "s" });
        let from = start + own;
        let key = word.split([':', ' ']).next().unwrap_or_default();
        Cause {
            span: Span::new(from, from + key.len().max(1)),
            message: format!("this line is indented by {}, its neighbours by {fits}", columns(own)),
            help: format!("indent it by {}", columns(fits)),
        }
    };
    let near: Vec<usize> = [Some(here), above(lines, here), below(lines, here)].into_iter().flatten().collect();
    let rare = near.iter().copied().filter(|i| in_column(dashed(*i), column(*i)) == 1).find_map(|i| {
        let fits = others(i).into_iter().find(|c| c.abs_diff(column(i)) == 1)?;
        Some((i, fits))
    });
    let between = || {
        near.iter().copied().filter(|i| !dashed(*i)).find_map(|i| {
            let (up, down) = (above(lines, i)?, below(lines, i)?);
            let fits = key_column(lines[down].1);
            (key_column(lines[up].1) == fits && !dashed(down) && fits != column(i)).then_some((i, fits))
        })
    };
    rare.or_else(between).map(|(i, fits)| cause(i, fits))
}

/// Lines with their places, without their ends.
fn lines(text: &str) -> Vec<(usize, &str)> {
    let mut begin = 0;
    let line = |line: &'_ str| {
        begin += line.len();
        begin - line.len()
    };
    let starts: Vec<usize> = text.split_inclusive('\n').map(line).collect();
    starts.into_iter().zip(text.split_inclusive('\n').map(str::trim_end)).collect()
}

/// A tab before the text of the line of `at` or of a neighbouring line.
fn tab_beside(text: &str, at: usize) -> Option<Cause> {
    let lines = lines(text);
    let here = lines.partition_point(|(start, _)| *start <= at).checked_sub(1)?;
    lines[here.saturating_sub(1)..lines.len().min(here + 2)].iter().find_map(|(start, line)| {
        let visible = line.trim_start();
        let tab = line[..line.len() - visible.len()].find('\t').filter(|_| !visible.starts_with('#'))?;
        Some(Cause::of(Span::new(start + tab, start + tab + 1), &ErrorKind::TabInIndentation))
    })
}

/// A character that only looks like a blank, in this line or the line above: part of a pasted key or indentation.
fn invisible_beside(lines: &[(usize, &str)], here: usize) -> Option<Cause> {
    [Some(here), above(lines, here)].into_iter().flatten().find_map(|i| {
        let (start, line) = lines[i];
        let content = line.split(" #").next().unwrap_or_default();
        let blank = |c: char| c.is_whitespace() || super::super::invisible(c).is_some();
        // Elsewhere than before a key or a value it is a part of a text, and no fault.
        let stands_before =
            |at: usize| matches!(content[..at].trim_end_matches(blank).chars().next_back(), None | Some(':' | '-'));
        let (at, c, name) = content
            .char_indices()
            .find_map(|(at, c)| Some((at, c, super::super::invisible(c).filter(|_| stands_before(at))?)))?;
        Some(Cause {
            span: Span::new(start + at, start + at + c.len_utf8()),
            message: format!("{name}, stands where YAML needs a space"),
            help: "type a space instead".to_owned(),
        })
    })
}

/// The line above, if it is no key but stands like one: it is taken to go on in the line of `at`, whose own colon is then one too many.
fn key_without_colon(text: &str, at: usize) -> Option<Cause> {
    let lines = lines(text);
    let here = lines.partition_point(|(start, _)| *start <= at).checked_sub(1)?;
    let mut above = lines[..here].iter().rev().filter(|(_, line)| !line.trim().is_empty());
    let (start, line) = above.next()?;
    let indentation = |line: &str| line.len() - line.trim_start_matches([' ', '-']).len();
    let own = text.get(lines[here].0..at)?;
    let word = line.trim_start();
    let like_a_key =
        !own.contains(':') && indentation(lines[here].1) == indentation(line) && !word.contains([':', '[', ']', '{', '}', ',']);
    // Below a key with a value it goes on with that.
    let begins = above.next().is_none_or(|(_, before)| before.ends_with(':') || indentation(before) >= indentation(line));
    (like_a_key && begins && !word.starts_with(['#', '-', '"', '\'']))
        .then(|| Cause::of(Span::new(start + line.len() - word.len(), start + line.len()), &ErrorKind::SimpleKeyExpected))
}

/// The quote that is open at the end of a text.
fn opened_quote(text: &str) -> Option<usize> {
    quote_and_comment(text).0
}

/// The quote that is open at the end of a text, and whether there is a comment before.
pub(super) fn quote_and_comment(text: &str) -> (Option<usize>, bool) {
    let mut comment = false;
    let mut open: Option<(usize, char)> = None;
    // The last character, and the last one that is no blank, a line's end among them.
    let (mut last, mut visible) = ('\n', '\n');
    let mut characters = text.char_indices().peekable();
    while let Some((at, c)) = characters.next() {
        match open {
            Some((_, '"')) if c == '\\' => drop(characters.next()),
            Some((_, '\'')) if c == '\'' && characters.next_if(|(_, next)| *next == '\'').is_some() => {}
            Some((_, quote)) if c == quote => open = None,
            Some(_) => {}
            None if c == '#' && last.is_whitespace() => {
                comment = true;
                while characters.next_if(|(_, next)| *next != '\n').is_some() {}
            }
            None if matches!(c, '"' | '\'') && matches!(visible, '\n' | ':' | '-' | '?' | '[' | '{' | ',') => {
                open = Some((at, c))
            }
            None => {}
        }
        last = c;
        if !c.is_whitespace() || c == '\n' {
            visible = c;
        }
    }
    (open.map(|(at, _)| at), comment)
}
