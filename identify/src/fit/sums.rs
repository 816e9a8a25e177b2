//! Sums over rows: Gram matrices and residuals of the same equations for many weights.
//!
//! The rows of a joint are gathered once, with the columns of their patterns, followed by the right-hand side.
//! A sum goes over tiles of 4 x 4 entries, which stay in registers while a block of rows passes.

use nalgebra::DVector;

use super::{Equations, Gram, Pattern};

/// Entries of a tile in a line.
const LANES: usize = 4;
/// Rows of a block: with their weighted copy they fit into a processor's first cache.
const BLOCK: usize = 32;

type Lanes = [f64; LANES];

/// Four columns of a block.
type Panel = [Lanes; BLOCK];

/// The rows of a joint.
#[derive(Clone, Debug, Default)]
struct Gathered {
    /// The columns of their patterns, by their places among the columns of the sums.
    columns: Vec<usize>,
    /// The rows of the equations.
    rows: Vec<usize>,
    /// Panels of a block: of the columns, the right-hand side, and zeros.
    width: usize,
    /// Panels, block by block. Behind the last row are zeros.
    panels: Vec<Panel>,
}

/// Some columns of equations, for sums.
#[derive(Clone, Debug)]
pub struct Sums {
    columns: usize,
    rows: usize,
    joints: Vec<Gathered>,
}

impl Sums {
    /// Gathers these columns.
    pub fn new(equations: &Equations, columns: &[usize]) -> Sums {
        let joints = equations.rows.iter().map(|row| row.joint + 1).max().unwrap_or(0);
        let mut all = vec![Gathered::default(); joints];
        let mut patterns = vec![vec![false; equations.patterns.len()]; joints];
        for (k, row) in equations.rows.iter().enumerate() {
            all[row.joint].rows.push(k);
            patterns[row.joint][equations.starts[k].0] = true;
        }
        for (of, is_there) in all.iter_mut().zip(&patterns) {
            let patterns = || equations.patterns.iter().zip(is_there).filter(|(_, is_there)| **is_there);
            let is_filled = |place: usize| patterns().any(|(pattern, _)| pattern.entry(place).is_some());
            of.columns = (0..columns.len()).filter(|&place| is_filled(columns[place])).collect();
            of.width = (of.columns.len() + 1).div_ceil(LANES);
            of.panels = vec![[[0.0; LANES]; BLOCK]; of.width * of.rows.len().div_ceil(BLOCK)];
            // Where entries of the first row of a block go, by pattern; those of the next are beside them.
            let start = |i: usize| i / LANES * BLOCK * LANES + i % LANES;
            let places = |pattern: &Pattern| -> Vec<(usize, usize)> {
                let entry = |(i, &place): (usize, &usize)| Some((start(i), pattern.entry(columns[place])?));
                of.columns.iter().enumerate().filter_map(entry).collect()
            };
            let places: Vec<Vec<(usize, usize)>> = equations.patterns.iter().map(places).collect();
            let last = start(of.columns.len());
            for (rows, block) in of.rows.chunks(BLOCK).zip(of.panels.chunks_exact_mut(of.width)) {
                let block = block.as_flattened_mut().as_flattened_mut();
                for (r, &k) in rows.iter().enumerate() {
                    let row = equations.row(k);
                    for &(start, entry) in &places[equations.starts[k].0] {
                        block[start + LANES * r] = row[entry];
                    }
                    block[last + LANES * r] = equations.b[k];
                }
            }
        }
        Sums { columns: columns.len(), rows: equations.rows.len(), joints: all }
    }

    /// Gram matrices by class of row: `class` gives the class of a row, below `classes`.
    pub fn grams(&self, weights: &[f64], classes: usize, class: impl Fn(usize) -> usize) -> Vec<Gram> {
        let mut all = vec![Gram::zero(self.columns); classes];
        for of in &self.joints {
            let mut tiles: Vec<Vec<[Lanes; LANES]>> = vec![Vec::new(); classes];
            let mut weighted = vec![[[0.0; LANES]; BLOCK]; of.width];
            for (rows, block) in of.rows.chunks(BLOCK).zip(of.panels.chunks_exact(of.width)) {
                let mut first = 0;
                while first < rows.len() {
                    let this = class(rows[first]);
                    let last = (first..rows.len()).find(|&r| class(rows[r]) != this).unwrap_or(rows.len());
                    // Rows of other classes have no weight.
                    let mut of_rows = [0.0; BLOCK];
                    (first..last).for_each(|r| of_rows[r] = weights[rows[r]]);
                    for (to, from) in weighted.iter_mut().zip(block) {
                        for r in 0..BLOCK {
                            for i in 0..LANES {
                                to[r][i] = of_rows[r] * from[r][i];
                            }
                        }
                    }
                    tiles[this].resize(of.width * of.width, [[0.0; LANES]; LANES]);
                    add(&mut tiles[this], &weighted, block);
                    first = last;
                }
            }
            for (gram, tiles) in all.iter_mut().zip(&tiles).filter(|(_, tiles)| !tiles.is_empty()) {
                of.scatter(tiles, gram);
            }
        }
        all
    }

    /// A'WA, A'Wb, b'Wb.
    pub fn gram(&self, weights: &[f64]) -> Gram {
        self.grams(weights, 1, |_| 0).pop().expect("one class")
    }

    /// b - A x, by row of the equations.
    pub fn residuals(&self, x: &DVector<f64>) -> Vec<f64> {
        let mut all = vec![0.0; self.rows];
        for of in &self.joints {
            // By lanes, as the columns; the right-hand side counts positively.
            let mut by = vec![[0.0; LANES]; of.width];
            of.columns.iter().zip(by.as_flattened_mut()).for_each(|(&place, by)| *by = -x[place]);
            if let Some(last) = by.as_flattened_mut().get_mut(of.columns.len()) {
                *last = 1.0;
            }
            for (rows, block) in of.rows.chunks(BLOCK).zip(of.panels.chunks_exact(of.width)) {
                let mut sums = [[0.0; LANES]; BLOCK];
                for (panel, by) in block.iter().zip(&by) {
                    for r in 0..BLOCK {
                        for i in 0..LANES {
                            sums[r][i] += panel[r][i] * by[i];
                        }
                    }
                }
                rows.iter().zip(&sums).for_each(|(&k, sum)| all[k] = sum.iter().sum());
            }
        }
        all
    }

    /// The rows of a joint, as places in the equations.
    pub fn rows(&self, joint: usize) -> &[usize] {
        self.joints.get(joint).map_or(&[], |of| &of.rows)
    }

    /// A'v over the rows of a joint, with a value for each of its rows.
    pub fn times(&self, joint: usize, mut values: impl Iterator<Item = f64>) -> DVector<f64> {
        let mut sum = DVector::zeros(self.columns);
        let Some(of) = self.joints.get(joint) else { return sum };
        let mut lanes = vec![[0.0; LANES]; of.width];
        for block in of.panels.chunks_exact(of.width) {
            let mut of_rows = [0.0; BLOCK];
            of_rows.iter_mut().zip(&mut values).for_each(|(to, value)| *to = value);
            for (sum, panel) in lanes.iter_mut().zip(block) {
                for r in 0..BLOCK {
                    for i in 0..LANES {
                        sum[i] += of_rows[r] * panel[r][i];
                    }
                }
            }
        }
        of.columns.iter().zip(lanes.as_flattened()).for_each(|(&place, x)| sum[place] = *x);
        sum
    }
}

impl Gathered {
    fn scatter(&self, tiles: &[[Lanes; LANES]], gram: &mut Gram) {
        let size = self.columns.len();
        let entry = |i: usize, k: usize| tiles[i / LANES * self.width + k / LANES][i % LANES][k % LANES];
        for (i, &row) in self.columns.iter().enumerate() {
            for (k, &column) in self.columns.iter().enumerate().skip(i) {
                let x = entry(i, k);
                gram.h[(row, column)] += x;
                if i != k {
                    gram.h[(column, row)] += x;
                }
            }
            gram.g[row] += entry(i, size);
        }
        gram.bb += entry(size, size);
    }
}

/// Adds left' right to the tiles on and above the diagonal.
fn add(tiles: &mut [[Lanes; LANES]], left: &[Panel], right: &[Panel]) {
    let width = left.len();
    for (i, left) in left.iter().enumerate() {
        for (k, right) in right.iter().enumerate().skip(i) {
            // By index: iterators over so short arrays are calls where they are not inlined.
            let mut sum = [[0.0; LANES]; LANES];
            for r in 0..BLOCK {
                for a in 0..LANES {
                    for b in 0..LANES {
                        sum[a][b] += left[r][a] * right[r][b];
                    }
                }
            }
            for (tile, sum) in tiles[i * width + k].as_flattened_mut().iter_mut().zip(sum.as_flattened()) {
                *tile += sum;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::{Equations, Pattern, Sums};
    use crate::fit::Row;

    /// Sums of small whole numbers are exact in any order: they equal the definition, for every class and joint.
    #[test]
    fn sums_are_those_of_their_definition() {
        let (columns, joints, count) = (11, 3, 200);
        let mut state = 1u64;
        let mut whole = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 40) % 9) as f64 - 4.0
        };
        // Column 3 is 0 throughout, joint 1 has the first five alone; the other rows have two patterns.
        let patterns = [(0..5).collect(), (0..columns).collect(), (0..columns).filter(|column| *column != 7).collect()];
        let mut equations = Equations::new(columns, patterns.into_iter().map(Pattern::new).collect(), count, count * columns);
        for k in 0..count {
            let joint = k % joints;
            let pattern = if joint == 1 { 0 } else { 1 + k / 100 };
            let entries = equations.push(Row { joint, log: 0, time: k as f64, counts: true }, whole(), pattern);
            entries.iter_mut().enumerate().filter(|(column, _)| *column != 3).for_each(|(_, x)| *x = whole());
        }
        let weights: Vec<f64> = (0..count).map(|_| whole().abs()).collect();
        let chosen = [9, 0, 3, 2, 7, 10];
        let (sums, class) = (Sums::new(&equations, &chosen), |k: usize| (k / 50) % 2);
        let at = |k: usize, place: usize| equations.at(k, chosen[place]);
        for (this, gram) in sums.grams(&weights, 2, class).iter().enumerate() {
            let sum =
                |of: &dyn Fn(usize) -> f64| -> f64 { (0..count).filter(|&k| class(k) == this).map(|k| weights[k] * of(k)).sum() };
            for i in 0..chosen.len() {
                for j in 0..chosen.len() {
                    assert_eq!(gram.h[(i, j)], sum(&|k| at(k, i) * at(k, j)), "{i}, {j}");
                }
                assert_eq!(gram.g[i], sum(&|k| at(k, i) * equations.b[k]));
            }
            assert_eq!(gram.bb, sum(&|k| equations.b[k].powi(2)));
        }
        let x = DVector::from_fn(chosen.len(), |i, _| i as f64 - 2.0);
        let residuals = sums.residuals(&x);
        for joint in 0..joints {
            let rows: Vec<usize> = (0..count).filter(|k| k % joints == joint).collect();
            assert_eq!(sums.rows(joint), rows);
            let product = sums.times(joint, rows.iter().map(|&k| weights[k]));
            for i in 0..chosen.len() {
                assert_eq!(product[i], rows.iter().map(|&k| weights[k] * at(k, i)).sum::<f64>());
            }
            for &k in &rows {
                assert_eq!(residuals[k], equations.b[k] - (0..chosen.len()).map(|i| at(k, i) * x[i]).sum::<f64>());
            }
        }
    }
}
