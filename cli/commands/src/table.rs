//! Aligned tables in plain text.

/// How a column stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// Rows under a header; cells are as wide as the widest of their column.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    columns: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these columns.
    pub(crate) fn new<const N: usize>(columns: [(&str, Align); N]) -> Table {
        Table { columns: columns.map(|(name, align)| (name.to_string(), align)).into(), rows: Vec::new() }
    }

    /// Adds a row.
    pub(crate) fn row<const N: usize>(&mut self, cells: [String; N]) {
        debug_assert_eq!(N, self.columns.len());
        self.rows.push(cells.into());
    }

    /// Whether a cell beyond the first of its row holds something.
    pub(crate) fn says_more_than_names(&self) -> bool {
        self.rows.iter().flat_map(|row| &row[1..]).any(|cell| !cell.is_empty())
    }

    /// The table, each line indented by two and ended by a line break; no header if no column has a name, no column that is empty.
    pub(crate) fn text(&self) -> String {
        let header: Vec<String> = self.columns.iter().map(|(name, _)| name.clone()).collect();
        let named = header.iter().any(|name| !name.is_empty());
        let lines: Vec<&Vec<String>> = named.then_some(&header).into_iter().chain(&self.rows).collect();
        let width = |j: usize| lines.iter().map(|line| line[j].chars().count()).max().unwrap_or(0);
        let kept: Vec<usize> = (0..header.len()).filter(|&j| self.rows.iter().any(|row| !row[j].is_empty())).collect();
        let widths: Vec<usize> = (0..header.len()).map(width).collect();
        let mut text = String::new();
        for line in lines {
            let cells: Vec<String> = kept
                .iter()
                .map(|&j| match self.columns[j].1 {
                    Align::Left => format!("{:<1$}", line[j], widths[j]),
                    Align::Right => format!("{:>1$}", line[j], widths[j]),
                })
                .collect();
            text.push_str(format!("  {}", cells.join("  ")).trim_end());
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_align_and_empty_ones_vanish() {
        let mut table = Table::new([("name", Align::Left), ("none", Align::Left), ("x", Align::Right)]);
        table.row(["a".into(), String::new(), "1".into()]);
        table.row(["längere".into(), String::new(), "10".into()]);
        assert_eq!(table.text(), "  name      x\n  a         1\n  längere  10\n");
    }
}
