//! Skinning and blended rotations against closed forms.

use crate::mesh::shapes::{Noise, grid, jittered};
use morsmooth::deform::skinning::{dual_quaternion, linear_blend};
use morsmooth::deform::{DeformError, determinant, rotations};
use morsmooth::mesh::{HandleTransform, Pose, Rotation};
use proptest::prelude::*;
use std::f64::consts::PI;

type Skin = fn(&[[f64; 3]], &[f64], &Pose) -> Result<Vec<[f64; 3]>, DeformError>;
const BOTH: [Skin; 2] = [linear_blend, dual_quaternion];

fn turn(rotation: Rotation, pivot: [f64; 3]) -> HandleTransform {
    HandleTransform { rotation, pivot, ..HandleTransform::REST }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

fn random_transform(noise: &mut Noise) -> HandleTransform {
    let mut triple = |size: f64| -> [f64; 3] { std::array::from_fn(|_| size * (2.0 * noise.next() - 1.0)) };
    let (axis, translation, pivot) = (triple(1.0), triple(3.0), triple(2.0));
    let rotation = Rotation::about(axis, 5.0 * noise.next()).unwrap();
    HandleTransform { rotation, translation, scale: 0.5 + noise.next(), pivot }
}

fn random_weights(noise: &mut Noise, vertices: usize, handles: usize) -> Vec<f64> {
    (0..vertices).flat_map(|_| {
        let row: Vec<f64> = (0..handles).map(|_| noise.next()).collect();
        let sum: f64 = row.iter().sum();
        row.into_iter().map(move |weight| weight / sum).collect::<Vec<_>>()
    }).collect()
}

#[test]
fn rest_stays_and_one_handle_moves_all_as_it_says() {
    let mesh = jittered([5, 4, 3], 0.2, 1);
    let count = mesh.vertex_count();
    let mut noise = Noise(5);
    let weights = random_weights(&mut noise, count, 3);
    let transform = random_transform(&mut noise);
    for skin in BOTH {
        let rest = skin(mesh.points(), &weights, &Pose::rest(3)).unwrap();
        assert!(rest.iter().zip(mesh.points()).all(|(a, b)| distance(*a, *b) < 1e-14));
        let moved = skin(mesh.points(), &vec![1.0; count], &Pose { transforms: vec![transform] }).unwrap();
        assert!(moved.iter().zip(mesh.points()).all(|(a, b)| distance(*a, transform.apply(*b)) < 1e-13));
        // All handles alike: weights do not matter, nor does their sum.
        let doubled: Vec<f64> = weights.iter().map(|weight| 2.0 * weight).collect();
        let moved = skin(mesh.points(), &doubled, &Pose { transforms: vec![transform; 3] }).unwrap();
        assert!(moved.iter().zip(mesh.points()).all(|(a, b)| distance(*a, transform.apply(*b)) < 1e-13));
    }
}

#[test]
fn translations_are_blended_linearly_by_both() {
    let shift = |translation| HandleTransform { translation, ..HandleTransform::REST };
    let pose = Pose { transforms: vec![shift([1.0, 2.0, 3.0]), shift([-3.0, 0.0, 1.0])] };
    for skin in BOTH {
        let moved = skin(&[[5.0, 6.0, 7.0]], &[0.25, 0.75], &pose).unwrap();
        assert!(distance(moved[0], [3.0, 6.5, 8.5]) < 1e-14, "{moved:?}");
    }
}

/// A bar whose right half turns by 90 degrees about the joint: at the joint's own line, with equal weights, linear blending keeps
/// cos 45 of the width, dual quaternions all of it.
#[test]
fn a_bent_bar_at_its_joint() {
    let angle = PI / 2.0;
    for (axis, sideways) in [([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]), ([0.0, 1.0, 0.0], [0.0, 0.0, -1.0])] {
        let pose = Pose { transforms: vec![HandleTransform::REST, turn(Rotation::about(axis, angle).unwrap(), [2.0, 0.0, 0.0])] };
        let point: [f64; 3] = std::array::from_fn(|k| [2.0, 0.0, 0.0][k] + sideways[k]);
        let half = turn(Rotation::about(axis, angle / 2.0).unwrap(), [2.0, 0.0, 0.0]).apply(point);
        let linear = linear_blend(&[point], &[0.5, 0.5], &pose).unwrap()[0];
        let dual = dual_quaternion(&[point], &[0.5, 0.5], &pose).unwrap()[0];
        assert!(distance(dual, half) < 1e-14, "{dual:?} {half:?}");
        let shrunk: [f64; 3] = std::array::from_fn(|k| [2.0, 0.0, 0.0][k] + (angle / 2.0).cos() * (half[k] - [2.0, 0.0, 0.0][k]));
        assert!(distance(linear, shrunk) < 1e-14, "{linear:?} {shrunk:?}");
    }
}

#[test]
fn quaternions_of_either_sign_blend_alike() {
    let mesh = grid([4, 3, 3]);
    let mut noise = Noise(9);
    let weights = random_weights(&mut noise, mesh.vertex_count(), 2);
    let transforms = vec![random_transform(&mut noise), random_transform(&mut noise)];
    let mut negated = transforms.clone();
    negated[1].rotation = Rotation::Quaternion(negated[1].rotation.quaternion().map(|part| -part));
    let about_z = Rotation::Angle(1.3).quaternion();
    let [plus, minus] = [about_z, about_z.map(|part| -part)].map(|quaternion| {
        let pose = Pose { transforms: vec![HandleTransform::REST, turn(Rotation::Quaternion(quaternion), [1.0, 0.0, 0.0])] };
        dual_quaternion(&[[2.0, 1.0, 0.0]], &[0.5, 0.5], &pose).unwrap()[0]
    });
    assert!(distance(plus, minus) < 1e-15, "{plus:?} {minus:?}");
    let (pose, other) = (Pose { transforms }, Pose { transforms: negated });
    let moved = [&pose, &other].map(|pose| dual_quaternion(mesh.points(), &weights, pose).unwrap());
    assert!(moved[0].iter().zip(&moved[1]).all(|(a, b)| distance(*a, *b) < 1e-13));
    let turned = [&pose, &other].map(|pose| rotations::blend(&mesh, &weights, pose).unwrap());
    let same = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]| a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-14);
    assert!(turned[0].iter().zip(&turned[1]).all(|(a, b)| same(a, b)));
}

#[test]
fn turns_go_the_way_that_was_asked() {
    for degrees in [170.0f64, 190.0, 270.0, 350.0, 360.0, 540.0, -720.0] {
        let angle = degrees.to_radians();
        let pivot = [1.0, 2.0, 0.0];
        let pose = Pose { transforms: vec![turn(Rotation::Angle(0.0), pivot), turn(Rotation::Angle(angle), pivot)] };
        let point = [4.0, 6.0, 0.0];
        let half = turn(Rotation::Angle(angle / 2.0), pivot).apply(point);
        let moved = dual_quaternion(&[point], &[0.5, 0.5], &pose).unwrap()[0];
        assert!(distance(moved, half) < 1e-12, "{degrees}: {moved:?} {half:?}");
        let mesh = grid([2, 2, 1]);
        let weights = [0.75, 0.25].repeat(4);
        let expected = Rotation::Angle(angle / 4.0).matrix();
        for found in rotations::blend(&mesh, &weights, &pose).unwrap() {
            assert!(found.iter().flatten().zip(expected.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-13), "{degrees}");
        }
    }
}

/// Where the pose moves a joint to, there both bones leave it, whatever the weights: the property of dual quaternions that keeps joints whole.
#[test]
fn a_joint_stays_a_joint() {
    let parent = HandleTransform { translation: [0.5, -1.0, 0.0], ..turn(Rotation::Angle(0.9), [0.0; 3]) };
    let joint = [3.0, 1.0, 0.0];
    let place = parent.apply(joint);
    let child = HandleTransform {
        translation: std::array::from_fn(|axis| place[axis] - joint[axis]),
        ..turn(Rotation::Angle(-1.7), joint)
    };
    let pose = Pose { transforms: vec![parent, child] };
    for weight in [0.0, 0.1, 0.5, 0.8, 1.0] {
        for skin in BOTH {
            assert!(distance(skin(&[joint], &[1.0 - weight, weight], &pose).unwrap()[0], place) < 1e-13);
        }
    }
}

#[test]
fn bad_weights_and_poses_are_refused() {
    let points = [[0.0; 3], [1.0; 3]];
    let words = |weights: &[f64], pose: &Pose| {
        let text = linear_blend(&points, weights, pose).unwrap_err().to_string();
        assert_eq!(dual_quaternion(&points, weights, pose).unwrap_err().to_string(), text);
        text
    };
    assert_eq!(words(&[1.0; 3], &Pose::rest(2)), "3 weights were given; 4 were expected");
    assert_eq!(words(&[], &Pose::rest(0)), "0 transforms of handles were given; 1 were expected");
    assert_eq!(words(&[0.5, 0.5, 0.0, 0.0], &Pose::rest(2)), "sum of the weights of vertex 1 is 0; a positive number was expected");
    assert!(words(&[0.5, 0.5, f64::NAN, 1.0], &Pose::rest(2)).starts_with("sum of the weights of vertex 1 is NaN"));
    let mut pose = Pose::rest(2);
    pose.transforms[1].scale = -1.0;
    assert_eq!(words(&[0.5; 4], &pose), "scale of handle 1 is -1; a positive number was expected");
    pose.transforms[1] = HandleTransform { rotation: Rotation::Quaternion([0.0; 4]), ..HandleTransform::REST };
    assert!(words(&[0.5; 4], &pose).starts_with("transform of handle 1 is NaN"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Skinning commutes with a rigid motion of the result; the rotations of elements are rotations; both have the same bits on one thread.
    #[test]
    fn blends_follow_the_frame_and_are_rotations(seed in 0u64..10_000, handles in 1usize..5, flat in any::<bool>()) {
        let mut noise = Noise(seed);
        let mesh = if flat { jittered([5, 4, 1], 0.2, seed) } else { jittered([4, 3, 3], 0.2, seed) };
        let weights = random_weights(&mut noise, mesh.vertex_count(), handles);
        let transforms: Vec<HandleTransform> = (0..handles).map(|_| HandleTransform { scale: 1.0, ..random_transform(&mut noise) }).collect();
        let motion = HandleTransform { scale: 1.0, ..random_transform(&mut noise) };
        // motion after transform, with the pivot of the transform.
        let after = |transform: &HandleTransform| {
            let place = motion.apply(transform.apply(transform.pivot));
            let [q, p] = [motion, *transform].map(|transform| transform.rotation.quaternion());
            let product = [
                q[0] * p[0] - q[1] * p[1] - q[2] * p[2] - q[3] * p[3],
                q[0] * p[1] + q[1] * p[0] + q[2] * p[3] - q[3] * p[2],
                q[0] * p[2] - q[1] * p[3] + q[2] * p[0] + q[3] * p[1],
                q[0] * p[3] + q[1] * p[2] - q[2] * p[1] + q[3] * p[0],
            ];
            let translation = std::array::from_fn(|axis| place[axis] - transform.pivot[axis]);
            HandleTransform { rotation: Rotation::Quaternion(product), translation, scale: 1.0, pivot: transform.pivot }
        };
        let pose = Pose { transforms: transforms.clone() };
        let moved_pose = Pose { transforms: transforms.iter().map(after).collect() };
        for skin in BOTH {
            let first = skin(mesh.points(), &weights, &pose).unwrap();
            let second = skin(mesh.points(), &weights, &moved_pose).unwrap();
            for (a, b) in first.iter().zip(&second) {
                prop_assert!(distance(motion.apply(*a), *b) < 1e-11, "{a:?} {b:?}");
            }
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            prop_assert_eq!(alone.install(|| skin(mesh.points(), &weights, &pose).unwrap()), first);
        }
        for rotation in rotations::blend(&mesh, &weights, &pose).unwrap() {
            prop_assert!((determinant(&rotation) - 1.0).abs() < 1e-12);
            for a in 0..3 {
                for b in 0..3 {
                    let product: f64 = (0..3).map(|k| rotation[k][a] * rotation[k][b]).sum();
                    prop_assert!((product - f64::from(u8::from(a == b))).abs() < 1e-12);
                }
            }
        }
    }
}
