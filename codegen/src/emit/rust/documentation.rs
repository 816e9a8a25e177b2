//! Documentation as Rust writes it: Markdown, names between back quotes.

use crate::emit::documentation::{linked, rows, Block, Link};

fn name(link: Link<'_>) -> String {
    let (Link::Function(name) | Link::Argument(name) | Link::Constant(name)) = link;
    format!("`{name}`")
}

/// The lines of documentation comments, each with the blank that follows `///`.
pub(super) fn lines(blocks: &[Block]) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, block) in blocks.iter().enumerate() {
        if i > 0 {
            lines.push(String::new());
        }
        match block {
            Block::Text(text) => lines.extend(text.iter().map(|line| format!(" {}", linked(line, &name)))),
            Block::Formula(formula) => lines.extend([" ```text".into(), format!(" {}", linked(formula, &name)), " ```".into()]),
            Block::Verbatim(text) => {
                lines.push(" ```text".into());
                lines.extend(text.iter().map(|line| format!(" {line}")));
                lines.push(" ```".into());
            }
            Block::List(items) => lines.extend(items.iter().map(|item| format!(" - {}", linked(item, &name)))),
            Block::Table(table) => {
                lines.push(" ```text".into());
                lines.extend(rows(table).map(|row| format!(" {row}")));
                lines.push(" ```".into());
            }
        }
    }
    lines
}
