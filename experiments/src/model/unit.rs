//! Units of recorded quantities.

use std::fmt;

use armgen_runtime::task::Row;

/// Units of channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A pure number, or a unit that depends on the task rows or on the parameter.
    None,
    /// s
    Second,
    /// m
    Metre,
    /// rad
    Radian,
    /// deg
    Degree,
    /// m/s
    MetrePerSecond,
    /// rad/s
    RadianPerSecond,
    /// m/s²
    MetrePerSecondSquared,
    /// rad/s²
    RadianPerSecondSquared,
    /// N m
    NewtonMetre,
    /// N
    Newton,
    /// 1/s
    PerSecond,
}

impl Unit {
    /// The printed symbol; empty for a pure number.
    pub const fn symbol(self) -> &'static str {
        match self {
            Unit::None => "",
            Unit::Second => "s",
            Unit::Metre => "m",
            Unit::Radian => "rad",
            Unit::Degree => "deg",
            Unit::MetrePerSecond => "m/s",
            Unit::RadianPerSecond => "rad/s",
            Unit::MetrePerSecondSquared => "m/s²",
            Unit::RadianPerSecondSquared => "rad/s²",
            Unit::NewtonMetre => "N m",
            Unit::Newton => "N",
            Unit::PerSecond => "1/s",
        }
    }

    /// Unit of a row of the operational space: m or rad.
    pub const fn of_row(row: Row) -> Unit {
        if row.is_angular() {
            Unit::Radian
        } else {
            Unit::Metre
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}
