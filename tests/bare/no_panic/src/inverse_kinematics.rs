//! Every block of inverse kinematics, with arguments opaque to the optimiser, and the steps of a module with their solutions.

use core::hint::black_box;

fn keep<V>(value: V) {
    black_box(value);
}

macro_rules! every_block {
    ($scalar:ident) => {
        #[allow(unreachable_pub, clippy::eq_op)]
        mod $scalar {
            use super::{black_box, keep};
            use armgen_inverse_kinematics::$scalar::*;

            const DOF: usize = 6;
            const LENGTH: Real = 1.0;
            const MAX_SOLUTIONS: usize = 16;
            const PRISMATIC: [bool; DOF] = [false, false, true, false, false, false];
            const POSITION_LIMITS: [[Real; 2]; DOF] = [[-3.0, 3.0]; DOF];

            type Solutions = Postures<DOF, MAX_SOLUTIONS>;

            fn number() -> Real {
                black_box(0.3)
            }

            fn frame() -> Frame {
                black_box([[number(); 4]; 3])
            }

            fn vector() -> Vector {
                black_box([number(); 3])
            }

            fn way<const J: usize>() -> Arrangement<J> {
                black_box(Arrangement {
                    order: [0; J],
                    prismatic: [false; J],
                    links: [frame(); J],
                    open: J - 1,
                    before: frame(),
                    after: frame(),
                    backward: false,
                    offsets: [[1.0, 0.0]; J],
                })
            }

            /// For each construction of a whole arm: its solutions, polished, in the arm's order, as a module returns them.
            fn whole<const N: usize>(mut found: Branches<6, N>, links: &[Frame; 6]) {
                polish(&mut found, &Loop { links, prismatic: black_box([false; 6]), target: [0.0; 3], length: number() });
                let way = way::<6>();
                let mut in_order: Branches<6, 16> = Branches::new();
                for branch in found.found() {
                    in_order.add(way.of_arm(branch));
                }
                solutions(&in_order);
            }

            fn solutions<const J: usize, const N: usize>(found: &Branches<J, N>) {
                let solutions: Solutions = conclude(found, black_box(PRISMATIC), black_box(true));
                let within = solutions.within(black_box(POSITION_LIMITS), black_box(PRISMATIC), black_box(LENGTH));
                keep((within, solutions.nearest(&[number(); DOF], black_box(PRISMATIC)), solutions.as_slice().len()));
            }

            /// Solutions of an arm of J joints, completed by virtual ones.
            fn few<const J: usize>(links: &[Frame; 6]) {
                let (arm, t) = (way::<6>(), frame());
                let flat = parallel_turns(&way::<4>().links_at(&t), [false; 3], regional_elbow);
                keep(without_virtual_joints::<4, J, 4>(&arm, &flat, &t, number(), ROUNDING));
                keep(without_virtual_joints::<6, J, 8>(&arm, &three_parallel(links), &t, number(), ROUNDING));
                let general = general_arm(&[way(), way()], &t, number());
                keep(without_virtual_joints::<6, J, 16>(&arm, &general, &t, number(), GENERAL_ROWS));
            }

            #[inline(never)]
            pub(crate) fn call() {
                keep(line_and_circle(number(), number(), number(), number(), number()));
                keep(turn([number(); 2], [number(); 2], number()));
                keep(two_turns(vector(), vector(), vector(), vector(), number()));
                keep(two_links(number(), number(), [number(); 2], number(), number()));
                keep(three_turns(&frame(), [number(); 2], [number(); 2], number(), number()));
                keep(circle_roots::<9, 20>(&[number(); 9], &[number(); 9], number(), number(), |_| [number(); 9]));
                let (links, prismatic) = (black_box([frame(); 6]), black_box([false; 3]));
                for block in [
                    regional_elbow,
                    regional_crossing,
                    regional_general,
                    regional_slide_elbow,
                    regional_slide_across,
                    regional_slide,
                    regional_mid_slide_elbow,
                    regional_mid_slide_across,
                    regional_mid_slide,
                    regional_plane_then_turn,
                    regional_slide_turn_slide,
                    regional_slides,
                ] {
                    whole(spherical_triple(&links, prismatic, block), &links);
                    let found = parallel_turns(&way::<4>().links_at(&frame()), prismatic, block);
                    keep(found.found().iter().map(|branch| way::<4>().of_arm(branch).free).sum::<u32>());
                    solutions(&found);
                    let links = [frame(), frame(), displaced(vector())];
                    let mut found = block(&links[0], &links[1], vector(), vector());
                    polish(&mut found, &Loop { links: &links, prismatic, target: vector(), length: number() });
                    solutions(&found);
                }
                whole(three_parallel(&links), &links);
                whole(three_prismatic(&links, black_box([0, 2, 4])), &links);
                whole(two_slides(&links, black_box([1, 3]), number()), &links);
                solutions(&general_arm(&[way(), way()], &frame(), number()));
                few::<1>(&links);
                few::<2>(&links);
                few::<3>(&links);
                few::<4>(&links);
                few::<5>(&links);
                keep((is_pose(&black_box([[number(); 4]; 4])), Solutions::none(Verdict::Invalid).of_rotation(&frame())));
            }
        }
    };
}

every_block!(f64);
every_block!(f32);

/// Calls every block in both scalars.
pub(crate) fn every_block() {
    f64::call();
    f32::call();
}
