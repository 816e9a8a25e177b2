//! The functions for many states give each state the bits that the function for one state gives it, whatever stands in the other lanes.

/// Compares functions of one emitted module, each with the numbers of the states that it takes, for more states than fill whole blocks.
macro_rules! check {
    ($module:ident: $($function:ident($($state:literal),*)),* $(,)?) => {
        #[allow(unreachable_pub)]
        mod $module {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($module), ".rs"));

            #[test]
            fn every_state_has_the_bits_of_its_own() {
                const COUNT: usize = 3 * lanes::LANES + 1;
                let states = |step: usize| -> Vec<[Real; DOF]> {
                    (0..COUNT).map(|k| core::array::from_fn(|i| ((k * step + i * 101) % 601) as Real / 100.0 - 3.0)).collect()
                };
                let mut s = [states(37), states(31), states(17), states(91)];
                // At rest, where the sign of a rate is zero, and beyond the range of fast sines.
                s[1][2] = [0.0; DOF];
                s[0][4][0] = 1.0e6;
                $({
                    let one: Vec<_> = (0..COUNT).map(|k| $function($(&s[$state][k]),*)).collect();
                    let mut many = vec![$function($(&s[$state][0]),*); COUNT];
                    batch::$function($(&s[$state],)* &mut many);
                    assert_eq!(one, many, "{}", stringify!($function));
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

check!(scara4_batch:
    direct_kinematics(0), link_frames(0), geometric_jacobian(0), geometric_jacobian_dot(0, 1), inertia_matrix(0), coriolis_matrix(0, 1),
    gravity(0), friction(1), equations_of_motion(0, 1), inverse_dynamics(0, 1, 2), forward_dynamics(0, 1, 3), regressor(0, 1, 1, 2),
    kinetic_energy(0, 1), potential_energy(0),
);
check!(scara4_batch_f32: direct_kinematics(0), inertia_matrix(0), coriolis_matrix(0, 1), equations_of_motion(0, 1));
check!(scara4_batch_std: direct_kinematics(0), forward_dynamics(0, 1, 3));
check!(ur5_batch:
    direct_kinematics(0), link_frames(0), geometric_jacobian(0), inertia_matrix(0), coriolis_matrix(0, 1), gravity(0),
    equations_of_motion(0, 1), forward_dynamics(0, 1, 3), regressor(0, 1, 1, 2), kinetic_energy(0, 1),
);
