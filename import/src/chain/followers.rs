//! Joints that follow others: which of them belong to the arm, how they move with the joints that have coordinates, and their limits.
//!
//! ```text
//! q_follower = factor · q_leader + offset          a leader may follow another joint itself
//! ```

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::exact::Number;
use armgen_codegen::source::Span;

use super::locks::{report_ring, report_unknown, Lock, Locks};
use super::Row;
use crate::format::{Format, Motion};
use crate::number::Decimal;
use crate::pose::factor;
use crate::tree::{Kind, Tree};
use crate::values::Values;
use crate::xml::shown;
use crate::Code;

/// How a joint follows another one.
#[derive(Clone, Debug)]
pub(crate) struct Follows {
    /// The joint that it follows: of a tree its index there, of an arm its row.
    pub(crate) leader: usize,
    /// 1 if the file gives none.
    pub(crate) factor: Decimal,
    pub(crate) offset: Decimal,
    pub(crate) span: Span,
}

impl Follows {
    /// The variable of the joint as a formula.
    pub(crate) fn formula(&self, leader: &str) -> String {
        let by = if self.factor.text == "1" { String::new() } else { format!("{} ", self.factor.text) };
        let offset = if self.offset.is_zero() { String::new() } else { format!(" + {}", factor(&self.offset.text)) };
        format!("{by}`{leader}`{offset}")
    }
}

/// The followers among the joints of an arm.
pub(super) struct Followers {
    by_joint: BTreeMap<usize, Follows>,
    /// Joints that belong to the arm since they move with it.
    pub(super) taken: Vec<usize>,
}

impl Followers {
    /// Extends the paths to the end effectors by all joints that move with them: leaders of their joints, and joints that follow those.
    /// Faults are reported.
    pub(super) fn take_in(
        (tree, format): (&Tree, &dyn Format),
        base: usize,
        path: &mut Vec<usize>,
        locks: &mut Locks,
        values: &mut Values<'_>,
    ) -> Followers {
        let below = below(tree, base);
        let given = path.len();
        let mut on_path: BTreeSet<usize> = path.iter().copied().collect();
        let mut by_joint = BTreeMap::new();
        let mut next = 0;
        while let Some(&joint) = path.get(next) {
            next += 1;
            if !locks.let_move(tree, joint) {
                continue;
            }
            let mut also = Vec::new();
            if let Some((leader, span)) = format.leader(joint) {
                if let Some(leader) = movable(tree, &below, base, (joint, leader, span), values) {
                    let (factor, offset) = format.ratio(joint, values);
                    let factor = factor.unwrap_or_else(Decimal::one);
                    if factor.is_zero() {
                        let at = Lock { text: offset.text, value: offset.value, ..Lock::at_zero(&tree.joints[joint]) };
                        locks.rest(tree, format, joint, at, values);
                        continue;
                    }
                    by_joint.insert(joint, Follows { leader, factor, offset, span });
                    also.push(leader);
                }
            }
            also.extend(locks.followers(joint).iter().filter(|&&other| below[other] && locks.let_move(tree, other)));
            for other in also {
                join(tree, base, other, path, &mut on_path);
            }
        }
        let taken = path[given..].iter().copied();
        let taken = taken.filter(|&joint| locks.let_move(tree, joint)).collect();
        let followers = Followers { by_joint, taken };
        followers.report_ring(tree, values);
        followers
    }

    /// Reports joints that follow each other.
    fn report_ring(&self, tree: &Tree, values: &mut Values<'_>) {
        let mut done = BTreeSet::new();
        for &start in self.by_joint.keys() {
            let (mut way, mut on_way, mut at) = (Vec::new(), BTreeSet::new(), start);
            while let Some(follows) = self.by_joint.get(&at).filter(|_| !done.contains(&at)) {
                if !on_way.insert(at) {
                    report_ring(tree, &way, at, follows.span, values);
                    return;
                }
                way.push(at);
                at = follows.leader;
            }
            done.extend(way);
        }
    }

    /// How a joint follows the joint of another row, if it does and both are rows.
    pub(super) fn of_row(&self, joint: usize, rows: &BTreeMap<usize, usize>) -> Option<Follows> {
        let follows = self.by_joint.get(&joint)?;
        Some(Follows { leader: *rows.get(&follows.leader)?, ..follows.clone() })
    }
}

/// Which joints are below a link.
fn below(tree: &Tree, base: usize) -> Vec<bool> {
    let mut below = vec![false; tree.joints.len()];
    let mut open = vec![base];
    while let Some(link) = open.pop() {
        for &joint in &tree.links[link].below {
            if !std::mem::replace(&mut below[joint], true) {
                open.push(tree.joints[joint].child);
            }
        }
    }
    below
}

/// Adds a joint below the base and those above it, from above.
fn join(tree: &Tree, base: usize, joint: usize, path: &mut Vec<usize>, on_path: &mut BTreeSet<usize>) {
    let mut way = Vec::new();
    let mut next = Some(joint);
    while let Some(joint) = next.filter(|&joint| on_path.insert(joint)) {
        way.push(joint);
        let parent = tree.joints[joint].parent;
        next = tree.links[parent].above.filter(|_| parent != base);
    }
    path.extend(way.into_iter().rev());
}

/// The leader of a joint, if it is one that can move; a fault is reported.
fn movable(
    tree: &Tree,
    below: &[bool],
    base: usize,
    (follower, leader, span): (usize, &str, Span),
    values: &mut Values<'_>,
) -> Option<usize> {
    let Some(found) = tree.joint(leader) else {
        report_unknown(tree, follower, leader, span, values);
        return None;
    };
    let (name, leader) = (shown(&tree.joints[follower].name), shown(leader));
    let lock = format!("lock it where it is to stand: `--lock {name}=0`");
    if tree.joints[found].kind == Kind::Other {
        let message = format!("the joint `{name}` follows `{leader}`, which is no joint about or along one axis");
        values.report(Code::Mimic, span, message, "", lock);
        return None;
    }
    if !below[found] {
        let message = format!("the joint `{name}` follows `{leader}`, which is not below `{}`", shown(&tree.links[base].name));
        values.report(Code::Mimic, span, message, "", format!("choose a `--base` above both, or {lock}"));
        return None;
    }
    Some(found)
}

/// A joint's variable by that of a joint with a coordinate.
struct Variable {
    root: usize,
    factor: Number,
    offset: Number,
}

/// The variable of a row, whose leaders form no ring.
fn variable(rows: &[Row], row: usize) -> Variable {
    let mut variable = Variable { root: row, factor: Number::one(), offset: Number::zero() };
    while let Some(follows) = &rows[variable.root].follows {
        variable.offset = variable.offset.plus(&variable.factor.times(&follows.offset.exact()));
        variable.factor = variable.factor.times(&follows.factor.exact());
        variable.root = follows.leader;
    }
    variable
}

/// Checks the couplings of the rows, and meets the limits of coordinates with those of their followers; faults and changes are reported.
pub(super) fn check(rows: &mut [Row], values: &mut Values<'_>) {
    let variables: Vec<Variable> = (0..rows.len()).map(|row| variable(rows, row)).collect();
    for row in 0..rows.len() {
        if rows[row].follows.is_some() {
            meet(rows, &variables, row, values);
        }
    }
}

/// Meets the limits of a follower with those of the joint whose coordinate moves it, and of the followers before it.
fn meet(rows: &mut [Row], variables: &[Variable], row: usize, values: &mut Values<'_>) {
    let root = &variables[row].root;
    let (name, leader) = (shown(&rows[row].joint), shown(&rows[*root].joint));
    let span = rows[row].span;
    let before = (0..rows.len()).filter(|other| variables[*other].root == *root && (*other < row || other == root));
    let before: Vec<usize> = before.collect();
    if let Some(own) = position(&rows[row], &variables[row]) {
        let known = before.iter().filter_map(|&other| position(&rows[other], &variables[other])).reduce(common);
        let both = known.clone().map_or(own.clone(), |known| common(known, own));
        if known.is_some() && (&both[1] - &both[0]).sign() != Ordering::Greater {
            let message = format!("the position limits of joint `{name}` allow its leader `{leader}` no motion");
            let help = "correct the limits or the multiplier in the file, or write limits into robot.yaml";
            values.report(Code::FollowerLimits, span, message, "its position limits are left out", help);
            rows[row].motion.position = None;
        } else if known.as_ref() != Some(&both) {
            let [low, high] = both.map(|end| end.to_f64());
            let message = format!("the position limits of joint `{name}` limit its leader `{leader}` to {low} and {high}");
            let help = "a leader moves as far as all that follow it: change them in robot.yaml if they are not meant";
            values.report(Code::FollowerLimits, span, message, "narrower than its leader's", help);
        }
    }
    let rates = |row: usize| {
        let Motion { velocity, acceleration, jerk, .. } = &rows[row].motion;
        let size = variables[row].factor.to_f64().abs();
        [velocity, acceleration, jerk].map(|limit| limit.as_ref().map(|limit| (limit.value / size, limit.span)))
    };
    for (k, what) in ["velocity", "acceleration", "jerk"].into_iter().enumerate() {
        let Some((own, span)) = rates(row)[k] else { continue };
        let known = before.iter().filter_map(|&other| rates(other)[k]).map(|(limit, _)| limit).reduce(f64::min);
        if known.is_none_or(|known| own < known * (1.0 - 1e-9)) {
            let message = format!("the {what} limit of joint `{name}` limits its leader `{leader}` to {own}");
            let help = "a leader moves as fast as all that follow it: change it in robot.yaml if it is not meant";
            values.report(Code::FollowerLimits, span, message, "lower than its leader's", help);
        }
    }
}

/// The position limits that a joint puts on the coordinate that moves it.
fn position(row: &Row, variable: &Variable) -> Option<[Number; 2]> {
    let inverse = variable.factor.inverse()?;
    let [low, high] = row.motion.position.as_ref()?.each_ref().map(|end| end.exact().minus(&variable.offset).times(&inverse));
    Some(if variable.factor.sign() == Ordering::Less { [high, low] } else { [low, high] })
}

/// The interval that two have in common.
fn common(one: [Number; 2], other: [Number; 2]) -> [Number; 2] {
    let [[low, high], [other_low, other_high]] = [one, other];
    let is_above = |a: &Number, b: &Number| (a - b).sign() == Ordering::Greater;
    [if is_above(&other_low, &low) { other_low } else { low }, if is_above(&high, &other_high) { other_high } else { high }]
}
