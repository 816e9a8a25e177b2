//! The firmware as linked: its sections, and the code size and stack frame of each function.

use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};
use std::collections::BTreeMap;

/// Sizes in bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Image {
    /// All code.
    pub(crate) text: u64,
    /// What lies in flash: code, constants, vectors, initial values.
    pub(crate) flash: u64,
    /// What lies in memory besides the stack.
    pub(crate) data: u64,
    /// Emitted functions: code size.
    pub(crate) functions: BTreeMap<String, u64>,
    /// Emitted functions: the stack that the function itself reserves, without those that it calls.
    pub(crate) frames: BTreeMap<String, u64>,
}

impl Image {
    pub(crate) fn read(bytes: &[u8]) -> Result<Image, object::Error> {
        let file = object::File::parse(bytes)?;
        let mut image = Image::default();
        for section in file.sections() {
            match section.kind() {
                SectionKind::Text => image.text += section.size(),
                SectionKind::Data | SectionKind::UninitializedData => image.data += section.size(),
                _ => {}
            }
            if matches!(section.kind(), SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::Data) {
                image.flash += section.size();
            }
        }
        let frames: BTreeMap<u64, u64> = match file.section_by_name(".stack_sizes") {
            Some(section) => stack_sizes(section.data()?).collect(),
            None => BTreeMap::new(),
        };
        for symbol in file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text) {
            let Ok(name) = symbol.name() else { continue };
            let name = format!("{:#}", rustc_demangle::demangle(name));
            let own = ["robot", "postures"].map(|module| format!("armgen_bare_control::{module}::"));
            let function = own.iter().find_map(|module| name.strip_prefix(module.as_str()));
            if let Some(function) = function.filter(|name| !name.contains("::")) {
                image.functions.insert(function.into(), symbol.size());
                // The lowest bit of the address says Thumb.
                if let Some(frame) = frames.get(&(symbol.address() & !1)) {
                    image.frames.insert(function.into(), *frame);
                }
            }
        }
        Ok(image)
    }
}

/// Addresses and frames: four bytes of the one, then the other as LEB128, again and again.
fn stack_sizes(mut data: &[u8]) -> impl Iterator<Item = (u64, u64)> + '_ {
    std::iter::from_fn(move || {
        let (address, mut rest) = data.split_first_chunk::<4>()?;
        let (mut size, mut shift) = (0u64, 0u32);
        loop {
            let (byte, after) = rest.split_first()?;
            rest = after;
            size |= u64::from(byte & 0x7f).checked_shl(shift)?;
            shift += 7;
            if byte & 0x80 == 0 {
                break;
            }
        }
        data = rest;
        Some((u64::from(u32::from_le_bytes(*address) & !1), size))
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn frames_are_read() {
        let data = [0x01, 0x10, 0, 0, 0x08, 0x00, 0x20, 0, 0, 0xc0, 0x07];
        assert_eq!(super::stack_sizes(&data).collect::<Vec<_>>(), [(0x1000, 8), (0x2000, 960)]);
    }
}
