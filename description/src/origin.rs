//! Where an emitted file comes from.

use sha2::{Digest, Sha256};

use crate::source::{is_hidden, Source};

/// The header that says where a file came from.
#[derive(Clone, Debug)]
pub struct Origin {
    /// File name of the description, without its folder.
    pub file: String,
    /// Hash of the description's text, hexadecimal.
    pub hash: String,
}

impl Origin {
    /// The origin of a description: its file name without the folder, so that the output is the same everywhere.
    pub fn of(source: &Source) -> Origin {
        let name = source.name().rsplit(['/', '\\']).next().unwrap_or_default();
        // In a comment, which a line break or a mark of writing direction would end or disguise, `*/` in C, a backslash or `coding=` in Python.
        let plain =
            |c: char| !is_hidden(c) && (c.is_alphanumeric() || c == ' ' || (c.is_ascii_graphic() && !"*\\?:=".contains(c)));
        let escaped = |c: char| if plain(c) { c.to_string() } else { format!("U+{:04X}", u32::from(c)) };
        // The head is read from the end of its line, so the name may contain anything.
        let file = name.chars().map(escaped).collect::<String>().replace("(input ", "U+0028input ");
        let digest = Sha256::digest(source.text().as_bytes());
        Origin { file, hash: digest.iter().take(8).map(|byte| format!("{byte:02x}")).collect() }
    }

    /// Version of armgen, file and hash: the origin as an emitted file states it.
    pub fn made_by(&self) -> String {
        format!("armgen {} from {} (input {})", env!("CARGO_PKG_VERSION"), self.file, self.hash)
    }
}

#[cfg(test)]
mod tests {
    use super::Origin;
    use crate::source::Source;

    #[test]
    fn the_name_of_a_file_cannot_leave_the_comment_it_stands_in() {
        let file = |name: &str| Origin::of(&Source::new(name, "")).file;
        assert_eq!(file("robots/my arm_2.yaml"), "my arm_2.yaml");
        assert_eq!(file("r\u{e4}der.yaml"), "r\u{e4}der.yaml");
        assert_eq!(file("a\nb\r*\u{202e}.yaml"), "aU+000AbU+000DU+002AU+202E.yaml");
        // The text before a slash is a folder.
        assert_eq!(file("a */ #define b /* (input c).yaml"), "U+002A U+0028input c).yaml");
        assert_eq!(file("a (2)\u{115f}.yaml"), "a (2)U+115F.yaml");
    }
}
