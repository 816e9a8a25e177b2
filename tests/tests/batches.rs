//! The functions for many states return the same bits for a state as the function for one state, whatever the other lanes hold.

/// Compares the functions of one emitted module, for more states than fill whole blocks.
macro_rules! check {
    ($module:ident: $($function:ident($($argument:ident),*)),*) => {
        #[allow(unreachable_pub)]
        mod $module {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($module), ".rs"));

            const COUNT: usize = 3 * lanes::LANES + 1;

            /// Arguments of all functions, state by state.
            #[allow(dead_code)]
            struct States {
                pi: Vec<[Real; PARAMETERS]>,
                q: Vec<[Real; DOF]>,
                dq: Vec<[Real; DOF]>,
                ddq: Vec<[Real; DOF]>,
                dqr: Vec<[Real; DOF]>,
                ddqr: Vec<[Real; DOF]>,
                tau: Vec<[Real; DOF]>,
            }

            fn states() -> States {
                let vectors = |step: usize| -> Vec<[Real; DOF]> {
                    (0..COUNT).map(|k| core::array::from_fn(|i| ((k * step + i * 101) % 601) as Real / 100.0 - 3.0)).collect()
                };
                let pi = (0..COUNT).map(|k| NOMINAL_PARAMETERS.map(|value| value * (1.0 + k as Real / 100.0))).collect();
                let (mut q, mut dq) = (vectors(37), vectors(31));
                // At rest, where the sign of a rate is zero, and beyond the range of fast sines.
                dq[2] = [0.0; DOF];
                q[4][0] = 1.0e6;
                States { pi, q, dq, ddq: vectors(17), dqr: vectors(23), ddqr: vectors(41), tau: vectors(91) }
            }

            #[test]
            fn every_state_has_the_bits_of_its_own() {
                let states = states();
                $({
                    let one: Vec<_> = (0..COUNT).map(|k| $function($(&states.$argument[k]),*)).collect();
                    let mut many = vec![$function($(&states.$argument[0]),*); COUNT];
                    batch::$function($(&states.$argument,)* &mut many);
                    // Compares text, which distinguishes the zeros and is the same for every NaN.
                    assert_eq!(format!("{one:?}"), format!("{many:?}"), "{}", stringify!($function));
                })*
            }

            #[test]
            fn the_shortest_slice_ends_the_work() {
                let q = [[0.5; DOF]; 2 * lanes::LANES];
                let mut many = [[[7.0; 4]; 4]; lanes::LANES + 1];
                batch::direct_kinematics(&q[..lanes::LANES - 1], &mut many);
                let (done, left) = many.split_at(lanes::LANES - 1);
                assert!(done.iter().all(|t| *t == direct_kinematics(&q[0])) && left.iter().flatten().flatten().all(|x| *x == 7.0));
                batch::direct_kinematics(&q, &mut many);
                assert!(many.iter().all(|t| *t == direct_kinematics(&q[0])));
            }
        }
    };
}

include!(concat!(env!("OUT_DIR"), "/batches.rs"));
