//! Aligned tables in plain text.

/// The alignment of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// For words.
    Left,
    /// For counts, and numbers among words.
    Right,
    /// For numbers: aligns their decimal points.
    Point,
}

/// Rows below a header; each column is as wide as its widest cell.
#[derive(Clone, Debug)]
pub struct Table {
    columns: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these columns.
    pub fn new<'a>(columns: impl IntoIterator<Item = (&'a str, Align)>) -> Table {
        Table { columns: columns.into_iter().map(|(name, align)| (name.to_string(), align)).collect(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
        debug_assert_eq!(self.rows.last().map(Vec::len), Some(self.columns.len()));
    }

    /// Whether any cell besides the first of its row is not empty.
    pub fn says_more_than_names(&self) -> bool {
        self.rows.iter().flat_map(|row| &row[1..]).any(|cell| !cell.is_empty())
    }

    /// Whether a column has content, so that the table shows it.
    pub fn shows(&self, column: &str) -> bool {
        let place = self.columns.iter().position(|(name, _)| name == column);
        place.is_some_and(|j| self.rows.iter().any(|row| !row[j].is_empty()))
    }

    /// The table, with lines indented by two characters. It omits a header without names, and empty columns. A table wider than a line is
    /// split into blocks, each with the first column.
    pub fn text(&self) -> String {
        self.within(crate::width())
    }

    /// The same with this line width, except for a single wider column.
    fn within(&self, most: usize) -> String {
        let header: Vec<String> = self.columns.iter().map(|(name, _)| name.clone()).collect();
        let named = header.iter().any(|name| !name.is_empty());
        let kept: Vec<usize> = (0..header.len()).filter(|&j| self.rows.iter().any(|row| !row[j].is_empty())).collect();
        let rows = self.with_points_aligned();
        let lines: Vec<&Vec<String>> = named.then_some(&header).into_iter().chain(&rows).collect();
        let width = |j: usize| lines.iter().map(|line| line[j].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..header.len()).map(width).collect();
        let mut blocks: Vec<Vec<usize>> = Vec::new();
        let mut used = 0;
        for &j in &kept {
            match blocks.last_mut() {
                Some(block) if used + 2 + widths[j] <= most => block.push(j),
                Some(_) => {
                    let first = kept[0];
                    blocks.push(vec![first, j]);
                    used = 2 + widths[first];
                }
                None => blocks.push(vec![j]),
            }
            used += 2 + widths[j];
        }
        let texts: Vec<String> = blocks.iter().map(|block| self.block(block, &lines, &widths)).collect();
        texts.join("\n")
    }

    /// The table restricted to some columns.
    fn block(&self, kept: &[usize], lines: &[&Vec<String>], widths: &[usize]) -> String {
        let mut text = String::new();
        for line in lines {
            let cells: Vec<String> = kept
                .iter()
                .map(|&j| match self.columns[j].1 {
                    Align::Left => format!("{:<1$}", line[j], widths[j]),
                    Align::Right | Align::Point => format!("{:>1$}", line[j], widths[j]),
                })
                .collect();
            text.push_str(format!("  {}", cells.join("  ")).trim_end());
            text.push('\n');
        }
        text
    }

    /// The rows, with blanks after numbers that have fewer decimals than others in their column.
    fn with_points_aligned(&self) -> Vec<Vec<String>> {
        let mut rows = self.rows.clone();
        for j in (0..self.columns.len()).filter(|&j| self.columns[j].1 == Align::Point) {
            let most = rows.iter().map(|row| from_the_point(&row[j])).max().unwrap_or(0);
            for cell in rows.iter_mut().map(|row| &mut row[j]) {
                let blanks = most - from_the_point(cell);
                cell.extend(std::iter::repeat_n(' ', blanks));
            }
        }
        rows
    }
}

/// The number of characters from the decimal point on.
fn from_the_point(number: &str) -> usize {
    number.find('.').map_or(0, |at| number.len() - at)
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

    #[test]
    fn wide_tables_come_in_blocks() {
        let mut table = Table::new([("name", Align::Left), ("a", Align::Right), ("b", Align::Right), ("c", Align::Right)]);
        table.row(["one".into(), "1000".into(), "2000".into(), "3000".into()]);
        assert_eq!(table.within(100), "  name     a     b     c\n  one   1000  2000  3000\n");
        assert_eq!(table.within(20), "  name     a     b\n  one   1000  2000\n\n  name     c\n  one   3000\n");
        assert!((12..40).all(|width| table.within(width).lines().all(|line| line.chars().count() <= width)));
    }

    #[test]
    fn points_stand_below_each_other() {
        let mut table = Table::new([("a", Align::Left), ("mass (kg)", Align::Point), ("x", Align::Point)]);
        table.row(["one".into(), "0.25".into(), "-1".into()]);
        table.row(["two".into(), "12".into(), "10.5".into()]);
        assert_eq!(table.text(), "  a    mass (kg)     x\n  one       0.25  -1\n  two      12     10.5\n");
    }
}
