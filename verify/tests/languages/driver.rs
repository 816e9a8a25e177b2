// Reads states from the file that the first argument names, writes the results of each function into a file of its name in the folder that
// the second names.

trait Flat {
    fn flat(&self, into: &mut Vec<u8>);
}

impl Flat for Real {
    fn flat(&self, into: &mut Vec<u8>) {
        into.extend(self.to_le_bytes());
    }
}

impl<T: Flat, const N: usize> Flat for [T; N] {
    fn flat(&self, into: &mut Vec<u8>) {
        self.iter().for_each(|entry| entry.flat(into));
    }
}

impl<A: Flat, B: Flat> Flat for (A, B) {
    fn flat(&self, into: &mut Vec<u8>) {
        self.0.flat(into);
        self.1.flat(into);
    }
}

impl<A: Flat, B: Flat, C: Flat> Flat for (A, B, C) {
    fn flat(&self, into: &mut Vec<u8>) {
        self.0.flat(into);
        self.1.flat(into);
        self.2.flat(into);
    }
}

struct States {
    numbers: Vec<Real>,
}

impl States {
    fn read() -> States {
        let bytes = std::fs::read(std::env::args().nth(1).expect("a file of states")).expect("the states");
        let number = |chunk: &[u8]| Real::from_le_bytes(chunk.try_into().expect("the bytes of a number"));
        States { numbers: bytes.chunks(size_of::<Real>()).map(number).collect() }
    }

    fn all(&self) -> impl Iterator<Item = &[Real]> {
        self.numbers.chunks(PARAMETERS + 6 * DOF + 3)
    }
}

fn write(name: &str, results: &[u8]) {
    let folder = std::env::args().nth(2).expect("a folder for the results");
    std::fs::write(format!("{folder}/{name}"), results).expect("the results");
}
