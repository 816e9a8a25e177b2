//! Formulas broken into lines: before the signs of a sum or between the factors of a product, the outermost that are enough.

use crate::ring::print::Notation;

/// Where a formula may be broken.
struct Break {
    /// Byte at which the next line begins, white space that is dropped included.
    at: usize,
    /// Within how many parentheses.
    depth: usize,
    /// 2 d before a sign and 2 d + 1 before a factor, at depth d.
    level: usize,
}

/// A formula in lines that are as wide as `width`, counted by `measure`, wherever it has a place to break.
pub(super) fn broken(formula: &str, notation: Notation, width: usize) -> Vec<String> {
    let measure = measure(notation);
    if measure(formula) <= width {
        return vec![formula.to_owned()];
    }
    // Each with the depth at which it begins.
    let mut units = vec![(formula, 0)];
    let mut inside = false;
    for level in 0.. {
        let mut deeper = false;
        units = units
            .into_iter()
            .flat_map(|(unit, depth)| {
                if measure(unit) <= width {
                    return vec![(unit, depth)];
                }
                let breaks = breaks(unit, depth, notation);
                deeper |= breaks.iter().any(|place| place.level > level);
                let mut parts = Vec::new();
                let mut start = (0, depth);
                for place in breaks.iter().filter(|place| place.level == level) {
                    parts.push((&unit[start.0..place.at], start.1));
                    start = (place.at, place.depth);
                    inside |= level > 1;
                }
                parts.push((&unit[start.0..], start.1));
                parts
            })
            .collect();
        if !deeper {
            break;
        }
    }
    let mut lines: Vec<String> = Vec::new();
    for (unit, _) in units {
        match lines.last_mut() {
            Some(line) if measure(line) + measure(unit) <= width => line.push_str(unit),
            _ => lines.push(unit.to_owned()),
        }
    }
    for line in lines.iter_mut() {
        *line = line.trim().to_owned();
        if notation == Notation::Latex {
            if let Some(factor) = line.strip_prefix("\\,") {
                *line = format!("\\cdot {factor}");
            }
            // A pair of \left and \right must not be taken apart.
            if inside {
                *line = line.replace("\\left(", "\\bigl(").replace("\\right)", "\\bigr)");
            }
        }
    }
    lines
}

/// Whether a formula is a sum, or begins with a sign.
pub(super) fn is_sum(formula: &str, notation: Notation) -> bool {
    formula.starts_with('-') || breaks(formula, 0, notation).iter().any(|place| place.level == 0)
}

/// Where a formula may be broken: nowhere within braces, which in LaTeX are one thing.
fn breaks(formula: &str, mut depth: usize, notation: Notation) -> Vec<Break> {
    let (mut found, mut braces) = (Vec::new(), 0usize);
    for (at, c) in formula.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            '{' => braces += 1,
            '}' => braces = braces.saturating_sub(1),
            _ => {}
        }
        let rest = &formula[at..];
        let sign = rest.starts_with(" + ") || rest.starts_with(" - ");
        let factor = match notation {
            Notation::Text => c == '*' || c == '/',
            Notation::Latex => rest.starts_with("\\,"),
        };
        // A break comes before a sign or factor, which begins the next part.
        if at > 0 && braces == 0 && (sign || factor) {
            found.push(Break { at, depth, level: 2 * depth + usize::from(factor) });
        }
    }
    found
}

/// How wide a formula is.
pub(super) fn measure(notation: Notation) -> fn(&str) -> usize {
    match notation {
        Notation::Text => |text| text.chars().count(),
        Notation::Latex => points,
    }
}

/// About how wide a formula is in points, in Computer Modern at 10 pt; of a fraction the wider part counts.
fn points(formula: &str) -> usize {
    let mut width = 0;
    let mut rest = formula;
    while let Some(c) = rest.chars().next() {
        rest = &rest[c.len_utf8()..];
        width += match c {
            '\\' => {
                let end = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
                let name = &rest[..end];
                rest = &rest[end.max(usize::from(end == 0 && !rest.is_empty()))..];
                match name {
                    "frac" => {
                        let (above, after) = group(rest);
                        let (below, after) = group(after);
                        rest = after;
                        points(above).max(points(below)) + 3
                    }
                    "sin" | "cos" => 16,
                    "left" | "right" | "bigl" | "bigr" => 3,
                    "dot" | "ddot" | "operatorname" | "mathit" | "mathcal" | "text" => 0,
                    "sqrt" => 9,
                    "qquad" => 20,
                    "arctan" => 30,
                    "cdot" => 7,
                    "" => 2,
                    _ => 7,
                }
            }
            // An index is smaller.
            '_' | '^' if rest.starts_with('{') => {
                let (index, after) = group(rest);
                rest = after;
                points(index) * 3 / 4 + 1
            }
            '{' | '}' | '_' | '^' => 0,
            ' ' if rest.starts_with("+ ") || rest.starts_with("- ") => 5,
            ' ' => 0,
            '+' | '-' | '=' => 8,
            '(' | ')' | ',' => 4,
            'm' | 'M' => 9,
            _ => 6,
        };
    }
    width
}

/// Content of the braces at the beginning of a text, and the rest after them.
fn group(text: &str) -> (&str, &str) {
    let mut depth = 0usize;
    for (at, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            let end = at + c.len_utf8();
            return (&text[..end], &text[end..]);
        }
    }
    (text, "")
}
