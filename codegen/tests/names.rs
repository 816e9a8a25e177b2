//! Names in emitted functions.

use std::collections::BTreeMap;

use armgen_codegen::program::listing::Name;
use armgen_codegen::ring::{AngleSum, Symbol};

fn name(sum: AngleSum) -> String {
    Name::SineOrCosine(Symbol::SineOf(sum)).text()
}

/// C and MATLAB distinguish names by their first 63 characters.
#[test]
fn names_of_sums_of_many_joints_are_told_apart() {
    let mut sums = BTreeMap::new();
    for first in 0..32 {
        for last in first..32 {
            // From one joint to another, all axes one way, or every other one the other way.
            let all = (u32::MAX >> (31 - (last - first))) << first;
            for other_way in [0, 0x5555_5555, 0xaaaa_aaaa] {
                let (plus, minus) = (all & !other_way, all & other_way);
                for turned in [false, true].into_iter().filter(|_| plus != 0) {
                    let sum = AngleSum { plus, minus, turned };
                    let name = name(sum);
                    assert!(name.len() <= 63 && name[1..].starts_with(|c: char| c.is_ascii_digit()), "{name}");
                    let other = sums.insert(name.clone(), sum);
                    assert!(other.is_none_or(|other| other == sum), "{name} is {other:?} and {sum:?}");
                }
            }
        }
    }
    assert_eq!(name(AngleSum { plus: 0b11, minus: 0b1000, turned: false }), "s1_2_less_4");
    assert_eq!(name(AngleSum { plus: 0x1ff_ffff, minus: 0, turned: false }), "s0x1ffffff");
}
