//! The constants of a module: their names, kinds and values.

use std::collections::BTreeMap;

use super::place::Place;
use crate::read::reader::constant::Constant;
use crate::read::reader::lexer::Fault;
use crate::read::reader::{constant_of, tips_of, OF_TIP};
use crate::values::contract::Sizes;
use crate::values::enclosure::Float;
use crate::values::program::{JOINTS, MOTORS, NOMINAL_GRAVITY, TIPS};

/// Maximum number of entries in an array of constants.
const MOST_ENTRIES: usize = 4096;
/// Maximum number of joints, above the limit of descriptions.
const MOST_JOINTS: usize = 128;

/// The notation of constants in a language.
#[derive(Clone, Copy, Debug)]
pub(in crate::read::reader) struct Constants {
    pub(in crate::read::reader) real: Float,
    pub(in crate::read::reader) suffix: &'static str,
    /// The quote around a text.
    pub(in crate::read::reader) quotes: char,
    /// Texts at the beginning of an array, between its entries and at its end, and the empty array; the flag marks an inner array.
    pub(in crate::read::reader) list: fn(Entry, bool) -> [&'static str; 4],
    pub(in crate::read::reader) truth: [&'static str; 2],
    /// Infinity; a minus sign precedes it if negative.
    pub(in crate::read::reader) infinity: &'static str,
}

/// The kind of a constant's entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::read::reader) enum Entry {
    Text,
    Integer,
    Truth,
    Real,
}

/// The permitted constants: name, kind of entries, and nesting depth of arrays.
pub(in crate::read::reader) const CONSTANTS: [(&str, Entry, usize); 25] = [
    ("NAME", Entry::Text, 0),
    ("DOF", Entry::Integer, 0),
    ("JOINT_NAMES", Entry::Text, 1),
    ("JOINT_IS_REVOLUTE", Entry::Truth, 1),
    ("POSITION_LIMITS", Entry::Real, 2),
    ("VELOCITY_LIMITS", Entry::Real, 1),
    ("EFFORT_LIMITS", Entry::Real, 1),
    ("ACCELERATION_LIMITS", Entry::Real, 1),
    ("JERK_LIMITS", Entry::Real, 1),
    (JOINTS, Entry::Integer, 0),
    ("ALL_JOINT_NAMES", Entry::Text, 1),
    ("COUPLING", Entry::Real, 2),
    ("COUPLING_OFFSET", Entry::Real, 1),
    (MOTORS, Entry::Integer, 0),
    ("MOTOR_RATES", Entry::Real, 2),
    ("TASK_ROWS", Entry::Integer, 0),
    ("TASK", Entry::Integer, 1),
    (TIPS, Entry::Text, 1),
    ("PARAMETERS", Entry::Integer, 0),
    ("PARAMETER_NAMES", Entry::Text, 1),
    ("NOMINAL_PARAMETERS", Entry::Real, 1),
    (NOMINAL_GRAVITY, Entry::Real, 1),
    ("BASE_PARAMETERS", Entry::Integer, 0),
    ("BASE_PARAMETER_NAMES", Entry::Text, 1),
    ("NOMINAL_BASE_PARAMETERS", Entry::Real, 1),
];

/// Whether only the modules of some arms have a constant.
pub(in crate::read::reader) fn is_of_some_arms(name: &str) -> bool {
    const OF_COUPLING: [&str; 6] = [JOINTS, "ALL_JOINT_NAMES", "COUPLING", "COUPLING_OFFSET", MOTORS, "MOTOR_RATES"];
    [NOMINAL_GRAVITY, TIPS, "TASK_ROWS", "TASK"].contains(&name) || OF_COUPLING.contains(&name) || name.contains("BASE_")
}

/// The kind of a constant's entries, and the nesting depth of its arrays.
fn kind_of(name: &str) -> Option<(Entry, usize)> {
    let known = CONSTANTS.iter().find(|(known, ..)| *known == name).map(|(_, entry, depth)| (*entry, *depth));
    let of_tip = || OF_TIP.iter().find(|own| name.strip_suffix(**own).is_some_and(|tip| tip.len() > 1 && tip.ends_with('_')));
    known.or_else(|| Some((Entry::Integer, usize::from(*of_tip()? != "TASK_ROWS"))))
}

/// The constants that follow another one: those of the end effectors that it names.
fn behind(name: &str, value: &Constant) -> Vec<String> {
    let of_tips = BTreeMap::from([(name.to_owned(), value.clone())]);
    tips_of(&of_tips).iter().flat_map(|tip| OF_TIP.map(|own| constant_of(tip, own))).collect()
}

/// Reads all constants in their order, by a function that reads a constant; it returns none for a constant that only some arms have.
pub(in crate::read::reader) fn in_order(
    names: impl IntoIterator<Item = &'static str>,
    mut read: impl FnMut(&str) -> Result<Option<Constant>, Fault>,
) -> Result<Vec<(String, Constant)>, Fault> {
    let mut constants = Vec::new();
    for name in names {
        let mut all = vec![name.to_owned()];
        let mut at = 0;
        while let Some(name) = all.get(at).cloned() {
            at += 1;
            if let Some(value) = read(&name)? {
                all.extend(behind(&name, &value));
                constants.push((name, value));
            }
        }
    }
    Ok(constants)
}

impl Constants {
    /// Reads the value of a constant.
    pub(in crate::read::reader) fn read(&self, name: &str, text: &str, line: usize) -> Result<Constant, Fault> {
        let mut place = Place { rest: text, line };
        let (entry, depth) = kind_of(name).ok_or_else(|| place.fault("there is no constant of that name"))?;
        let value = self.value(&mut place, entry, depth, false)?;
        place.ends()?;
        Ok(value)
    }

    fn value(&self, place: &mut Place<'_>, entry: Entry, depth: usize, inner: bool) -> Result<Constant, Fault> {
        if depth > 0 {
            let [begin, between, end, empty] = (self.list)(entry, inner);
            if place.eat(empty) {
                return Ok(Constant::Array(Vec::new()));
            }
            place.expect(begin)?;
            let mut entries = Vec::new();
            while entries.is_empty() || !place.eat(end) {
                if !entries.is_empty() {
                    place.expect(between)?;
                }
                if entries.len() == MOST_ENTRIES {
                    return Err(place.fault("a constant has too many entries"));
                }
                entries.push(self.value(place, entry, depth - 1, true)?);
            }
            return Ok(Constant::Array(entries));
        }
        Ok(match entry {
            Entry::Text => {
                place.expect(self.quotes.encode_utf8(&mut [0; 4]))?;
                let start = *place;
                let (text, rest) = place.rest.split_once(self.quotes).ok_or_else(|| start.fault("a text should end"))?;
                if !text.chars().all(|c| c.is_alphanumeric() || c == '_' || !c.is_ascii()) {
                    return Err(start.fault("a name can stand"));
                }
                place.rest = rest;
                Constant::Text(text.into())
            }
            Entry::Integer => Constant::Integer(place.integer()? as u64),
            Entry::Truth => {
                let found = self.truth.iter().position(|word| place.eat(word));
                Constant::Truth(found.ok_or_else(|| place.fault("a truth value can stand"))? == 1)
            }
            Entry::Real => {
                let negative = place.eat("-");
                if place.eat(self.infinity) {
                    Constant::Infinite(negative)
                } else {
                    Constant::Number(negative, place.literal(self.real, self.suffix)?)
                }
            }
        })
    }
}

/// The sizes in the constants of a module.
pub(in crate::read::reader) fn sizes(constants: &BTreeMap<String, Constant>) -> Result<Sizes, Fault> {
    let of = |name: &str, most: usize| match constants.get(name) {
        Some(Constant::Integer(value)) if *value <= most as u64 => Ok(*value as usize),
        None => Ok(0),
        Some(_) => Err(Fault { line: 1, reason: format!("`{name}` is more than {most}") }),
    };
    let tips = tips_of(constants).into_iter().map(|tip| {
        let rows = of(&constant_of(&tip, "TASK_ROWS"), 6)?;
        Ok((tip, rows))
    });
    Ok(Sizes {
        n: of("DOF", MOST_JOINTS)?,
        joints: if constants.contains_key(JOINTS) { Some(of(JOINTS, MOST_JOINTS)?) } else { None },
        p: of("PARAMETERS", MOST_ENTRIES)?,
        b: of("BASE_PARAMETERS", MOST_ENTRIES)?,
        m: of("TASK_ROWS", 6)?,
        gravity: constants.contains_key(NOMINAL_GRAVITY),
        tips: tips.collect::<Result<_, Fault>>()?,
    })
}
