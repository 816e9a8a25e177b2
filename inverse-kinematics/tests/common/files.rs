// The files of tests/data.

pub struct Pose {
    pub kind: String,
    pub verdicts: Vec<String>,
    pub t: Frame,
    pub redundancy: Option<f64>,
    pub met: Option<Vec<f64>>,
    pub solutions: Vec<(Vec<f64>, f64)>,
}

pub struct Reference {
    pub arm: Arm,
    pub planar: bool,
    pub given: Option<usize>,
    pub most: usize,
    pub poses: Vec<Pose>,
}

pub fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> Vec<f64> {
    words.map(|w| w.parse().unwrap()).collect()
}

pub fn read(name: &str) -> Reference {
    let path = format!("{}/tests/data/{name}.txt", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let (mut rows, mut prismatic) = (vec![], vec![]);
    let mut r = Reference { arm: Arm { c: vec![], prismatic: vec![] }, planar: false, given: None, most: 0, poses: vec![] };
    for line in text.lines() {
        let mut words = line.split(' ');
        match words.next().unwrap() {
            "joint" => {
                if words.next() == Some("prismatic") {
                    prismatic.push(rows.len());
                }
                let [theta, d, a, alpha] = numbers(words)[..] else { panic!("{line}") };
                rows.push((theta, d, a, alpha));
            }
            "target" => r.planar = words.next() == Some("planar"),
            "given" => r.given = words.next().map(|w| w.parse().unwrap()),
            "most" => r.most = words.next().unwrap().parse().unwrap(),
            "pose" => r.poses.push(Pose {
                kind: words.next().unwrap().into(),
                verdicts: words.map(String::from).collect(),
                t: IDENTITY,
                redundancy: None,
                met: None,
                solutions: vec![],
            }),
            key => {
                let pose = r.poses.last_mut().unwrap();
                match key {
                    "t" => {
                        let n = numbers(words);
                        pose.t = std::array::from_fn(|i| std::array::from_fn(|j| n[4 * i + j] as Real));
                    }
                    "redundancy" => pose.redundancy = Some(numbers(words)[0]),
                    "met" => pose.met = Some(numbers(words)),
                    "q" => {
                        let words: Vec<_> = words.collect();
                        let at = words.iter().position(|w| *w == "sigma").unwrap();
                        pose.solutions.push((numbers(words[..at].iter().copied()), words[at + 1].parse().unwrap()));
                    }
                    _ => panic!("{line}"),
                }
            }
        }
    }
    r.arm = Arm::standard(&rows, &prismatic);
    r
}

/// The arm with what a pose leaves open: a given joint locked, a slide along the axis of a planar arm.
pub fn completed(reference: &Reference, pose: &Pose) -> Arm {
    let mut arm = reference.arm.clone();
    if let (Some(given), Some(value)) = (reference.given, pose.redundancy) {
        let joint = joint_then(arm.prismatic[given], arm.value(given, value), &arm.c[given + 1]);
        arm.c[given] = compose(&arm.c[given], &joint);
        arm.c.remove(given + 1);
        arm.prismatic.remove(given);
    }
    if reference.planar {
        arm.c.push(IDENTITY);
        arm.prismatic.push(true);
    }
    arm
}

