//! Handles on meshes: who carries what, and what is refused.

use super::shapes::{Noise, grid, jittered, mapped};
use crate::support::shared;
use morsmooth::field::VertexId;
use morsmooth::io::{domain, read, read_handles};
use morsmooth::mesh::{AttachOptions, AttachedHandles, Handle, HandleError, HandleSet, HandleShape, Mask, SimplicialComplex};
use proptest::prelude::*;

fn point(name: &str, place: [f64; 3]) -> Handle {
    Handle { name: name.into(), shape: HandleShape::Point(place) }
}

fn bone(name: &str, root: [f64; 3], tip: [f64; 3]) -> Handle {
    Handle { name: name.into(), shape: HandleShape::Bone([root, tip]) }
}

fn region(name: &str, vertices: &[u32]) -> Handle {
    Handle { name: name.into(), shape: HandleShape::Region(vertices.iter().map(|&vertex| VertexId(vertex)).collect()) }
}

fn set(handles: Vec<Handle>) -> HandleSet {
    HandleSet { handles, cage_edges: Vec::new() }
}

fn attach(complex: &SimplicialComplex, handles: Vec<Handle>) -> Result<AttachedHandles, HandleError> {
    set(handles).attach(complex, &AttachOptions::default())
}

fn numbers(vertices: &[VertexId]) -> Vec<u32> {
    vertices.iter().map(|vertex| vertex.0).collect()
}

/// At every held vertex the values of all handles sum to 1, each in [0, 1]; the lists hold the same vertices, rising.
fn check_unity(attached: &AttachedHandles) {
    let rows: Vec<_> = (0..attached.len()).map(|handle| attached.boundary_values(handle)).collect();
    for place in 0..rows[0].len() {
        let sum: f64 = rows.iter().map(|row| row[place].1).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        assert!(rows.iter().all(|row| row[place].0 == rows[0][place].0 && (0.0..=1.0).contains(&row[place].1)));
    }
    assert!(rows[0].windows(2).all(|pair| pair[0].0 < pair[1].0));
}

#[test]
fn a_point_is_carried_by_the_nearest_vertex_the_lowest_of_several() {
    let mesh = grid([5, 4, 1]);
    let attached = attach(&mesh, vec![point("a", [3.3, 1.6, 0.0]), point("b", [0.5, 0.5, 0.0])]).unwrap();
    assert_eq!(numbers(&attached.vertices()[0]), [13]);
    assert_eq!(numbers(&attached.vertices()[1]), [0], "four vertices are equally near");
    assert_eq!(attached.boundary_values(1), [(VertexId(0), 1.0), (VertexId(13), 0.0)]);
}

#[test]
fn a_bone_is_carried_by_the_vertices_on_it() {
    let mesh = grid([6, 5, 1]);
    let attached = attach(&mesh, vec![bone("a", [1.0, 2.0, 0.0], [4.0, 2.0, 0.0])]).unwrap();
    assert_eq!(numbers(&attached.vertices()[0]), [13, 14, 15, 16]);
    // Along a diagonal of the subdivision.
    let attached = attach(&mesh, vec![bone("a", [0.0, 0.0, 0.0], [4.0, 4.0, 0.0])]).unwrap();
    assert_eq!(numbers(&attached.vertices()[0]), [0, 7, 14, 21, 28]);
}

#[test]
fn a_bone_between_the_vertices_is_carried_by_a_chain_along_it() {
    for (dims, ends) in [
        ([30, 20, 1], [[2.3, 3.4, 0.0], [26.1, 15.7, 0.0]]),
        ([12, 10, 9], [[1.2, 2.3, 3.4], [9.6, 7.1, 6.2]]),
    ] {
        let mesh = jittered(dims, 0.3, 7);
        let attached = attach(&mesh, vec![bone("a", ends[0], ends[1])]).unwrap();
        let vertices = &attached.vertices()[0];
        let length = (0..3).map(|axis| (ends[1][axis] - ends[0][axis]).powi(2)).sum::<f64>().sqrt();
        assert!(vertices.len() as f64 >= length / 2.0, "{} vertices for length {length}", vertices.len());
        for &vertex in vertices {
            let offset: Vec<f64> = (0..3).map(|axis| mesh.point(vertex)[axis] - ends[0][axis]).collect();
            let along: f64 = (0..3).map(|axis| offset[axis] * (ends[1][axis] - ends[0][axis]) / length).sum();
            let square: f64 = offset.iter().map(|part| part * part).sum();
            let distance = (square - along * along).max(0.0).sqrt();
            assert!(distance < 1.5, "vertex {vertex} is {distance} away");
        }
        // One connected chain.
        let mut reached = vec![vertices[0]];
        let mut place = 0;
        while place < reached.len() {
            for &next in mesh.neighbours(reached[place]) {
                if vertices.binary_search(&next).is_ok() && !reached.contains(&next) {
                    reached.push(next);
                }
            }
            place += 1;
        }
        assert_eq!(reached.len(), vertices.len(), "in one piece");
    }
}

#[test]
fn bones_share_their_joint_equally() {
    let mesh = grid([7, 7, 1]);
    let middle = [3.0, 3.0, 0.0];
    let bones = vec![
        bone("left", [0.0, 3.0, 0.0], middle),
        bone("right", middle, [6.0, 3.0, 0.0]),
        bone("up", middle, [3.0, 6.0, 0.0]),
    ];
    let attached = attach(&mesh, bones).unwrap();
    assert_eq!(attached.shared().len(), 1);
    assert_eq!(attached.shared()[0].vertex, VertexId(24));
    let third = 1.0 / 3.0;
    assert_eq!(attached.shared()[0].shares, [(0, third), (1, third), (2, third)]);
    assert_eq!(numbers(&attached.vertices()[0]), [21, 22, 23]);
    check_unity(&attached);
}

#[test]
fn vertices_on_a_cage_edge_belong_to_both_ends_linearly() {
    let mesh = grid([5, 5, 1]);
    let corners = vec![point("a", [0.0; 3]), point("b", [4.0, 0.0, 0.0]), point("c", [4.0, 4.0, 0.0])];
    let cage = HandleSet { handles: corners, cage_edges: vec![[0, 1], [1, 2]] };
    let attached = cage.attach(&mesh, &AttachOptions::default()).unwrap();
    let values: Vec<(u32, f64)> = attached.boundary_values(0).iter().map(|&(vertex, value)| (vertex.0, value)).collect();
    assert_eq!(values[..5], [(0, 1.0), (1, 0.75), (2, 0.5), (3, 0.25), (4, 0.0)]);
    assert_eq!(attached.shared().len(), 6);
    check_unity(&attached);
    for (cage_edges, words) in [
        (vec![[0, 0]], "cage edge 0 joins point \"a\" and point \"a\"; expected two different point handles"),
        (vec![[0, 1], [1, 5]], "cage edge 1 joins point \"b\" and handle 5 of 3; expected two different point handles"),
    ] {
        let wrong = HandleSet { cage_edges, ..cage.clone() };
        assert_eq!(wrong.attach(&mesh, &AttachOptions::default()).unwrap_err().to_string(), words);
    }
    // A third handle on the edge cannot have the weight that the edge says.
    let mut blocked = cage;
    blocked.handles.push(point("d", [2.0, 0.0, 0.0]));
    let error = blocked.attach(&mesh, &AttachOptions::default()).unwrap_err();
    assert!(matches!(error, HandleError::Shared { ref second, vertex: VertexId(2), .. } if second == "d"), "{error}");
}

#[test]
fn what_cannot_be_attached_is_named() {
    let mesh = grid([5, 5, 1]);
    let words = |handles| attach(&mesh, handles).unwrap_err().to_string();
    assert_eq!(words(vec![]), "no handle; expected at least one");
    assert_eq!(
        words(vec![point("hand", [9.0, 2.0, 0.0])]),
        "handle \"hand\" is outside the mesh: [9.0, 2.0, 0.0] is 5.000e0 from the nearest vertex 14; expected at most 1.414e0"
    );
    assert!(words(vec![bone("arm", [2.0, 2.0, 0.0], [9.0, 2.0, 0.0])]).starts_with("handle \"arm\" is outside the mesh: ["));
    assert_eq!(
        words(vec![point("a", [1.0, 1.0, 0.0]), point("b", [1.1, 1.0, 0.0])]),
        "handles \"a\" and \"b\" are both at vertex 6 at [1.0, 1.0, 0.0]; expected a vertex each: move one of them or refine the mesh"
    );
    assert!(words(vec![bone("a", [0.0, 2.0, 0.0], [4.0, 2.0, 0.0]), bone("b", [2.0, 0.0, 0.0], [2.0, 4.0, 0.0])]).contains("\"a\" and \"b\" are both at vertex 12"));
    assert_eq!(words(vec![region("r", &[])]), "handle \"r\" has no vertex: its list of vertices is empty");
    assert_eq!(words(vec![region("r", &[3, 25])]), "region \"r\" names vertex 25; expected less than 25");
    assert_eq!(words(vec![region("r", &[3]), region("r", &[4])]), "handles 0 and 1 are both named \"r\"; expected different names");
    assert_eq!(words(vec![bone("b", [1.0; 3], [1.0; 3])]), "bone \"b\" starts and ends at [1.0, 1.0, 1.0]; expected two places");
    assert_eq!(words(vec![point("p", [f64::NAN, 0.0, 0.0])]), "handle \"p\" is at [NaN, 0.0, 0.0]; expected finite numbers");
    // Two bones between the same two vertices leave the second none of its own; so does a bone shorter than an edge.
    let short = vec![bone("long", [0.0, 2.0, 0.0], [2.0, 2.0, 0.0]), bone("short", [2.0, 2.0, 0.0], [2.2, 2.0, 0.0])];
    assert!(words(short).starts_with("handle \"short\" has no vertex: every vertex along it belongs to a joint"));
}

#[test]
fn parts_without_a_handle_and_vertices_without_a_cell_are_refused() {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [5.0, 0.0], [6.0, 0.0], [5.0, 1.0], [9.0, 9.0]].map(|[x, y]| [x, y, 0.0]);
    let two = SimplicialComplex::new(2, points[..6].to_vec(), vec![0, 1, 2, 3, 4, 5]).unwrap();
    assert_eq!(
        attach(&two, vec![region("a", &[1])]).unwrap_err().to_string(),
        "the part of 3 vertices around vertex 3 at [5.0, 0.0, 0.0] has no handle (2 connected parts in all); expected a handle on every part"
    );
    attach(&two, vec![region("a", &[1]), region("b", &[4])]).unwrap();
    let lonely = SimplicialComplex::new(2, points.to_vec(), vec![0, 1, 2, 3, 4, 5]).unwrap();
    assert_eq!(
        attach(&lonely, vec![region("a", &[1]), region("b", &[4])]).unwrap_err().to_string(),
        "vertex 6 at [9.0, 9.0, 0.0] is not a corner of any cell (1 such vertices); expected none: remove them first"
    );
}

#[test]
fn size_of_the_mesh_does_not_matter() {
    let mesh = jittered([12, 9, 1], 0.3, 3);
    let handles = |scale: f64| {
        let at = |x: f64, y: f64| [scale * x, scale * y, 0.0];
        vec![point("p", at(10.2, 1.1)), bone("b", at(1.1, 1.2), at(6.3, 4.4)), bone("c", at(6.3, 4.4), at(4.0, 7.5))]
    };
    let attached = attach(&mesh, handles(1.0)).unwrap();
    for scale in [1e-8, 1e8] {
        let scaled = mapped(&mesh, |point| point.map(|part| scale * part));
        assert_eq!(attach(&scaled, handles(scale)).unwrap(), attached);
    }
}

#[test]
fn regions_follow_the_numbers_of_the_domain() {
    let old = set(vec![region("a", &[0, 2]), point("p", [0.0; 3])]);
    let table = [Some(VertexId(5)), None, Some(VertexId(1))];
    assert_eq!(old.renumbered(&table).unwrap().handles[0], region("a", &[5, 1]));
    let error = set(vec![region("a", &[1])]).renumbered(&table).unwrap_err();
    assert_eq!(error.to_string(), "region \"a\" names point 1, which is not in the domain; expected points of cells that are not masked");
    assert!(matches!(set(vec![region("a", &[3])]).renumbered(&table), Err(HandleError::VertexOutOfRange { vertices: 3, .. })));
}

#[test]
fn the_skeleton_of_a_hand_lies_on_vertices_of_its_mesh() {
    let (Some(mesh), Some(handles)) = (shared("tets/hand.mesh"), shared("tets/hand.tgf")) else { return };
    let dataset = read(mesh).unwrap();
    let domain = domain(&dataset, &Mask::none()).unwrap();
    let set = read_handles(handles).unwrap();
    assert_eq!(set.len(), 20);
    let attached = set.attach(&domain.complex, &AttachOptions::default()).unwrap();
    check_unity(&attached);
    let on_bones: usize = attached.vertices().iter().map(Vec::len).sum::<usize>() + attached.shared().len();
    // Twelve a bone, a joint once: as libigl's boundary_conditions finds them.
    assert_eq!(on_bones, 221);
    for (handle, vertices) in set.handles.iter().zip(attached.vertices()) {
        let HandleShape::Bone([root, tip]) = handle.shape else { panic!("{handle:?}") };
        for &vertex in vertices {
            let place = domain.complex.point(vertex);
            let between = |axis: usize| (root[axis].min(tip[axis]) - 1e-3..=root[axis].max(tip[axis]) + 1e-3).contains(&place[axis]);
            assert!((0..3).all(between), "{place:?} is not on {handle:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Random points, bones and a cage on random meshes either attach, sums of weights 1, or are refused for one of the documented reasons.
    #[test]
    fn random_handles_attach_or_are_refused(seed in 0u64..1000, flat in any::<bool>(), count in 1usize..6) {
        let mut noise = Noise(seed);
        let dims = if flat { [9, 8, 1] } else { [6, 5, 4] };
        let mesh = jittered(dims, 0.3, seed);
        let place = |noise: &mut Noise| -> [f64; 3] { std::array::from_fn(|axis| 1.05 * noise.next() * (dims[axis] - 1) as f64) };
        let handles: Vec<Handle> = (0..count).map(|number| {
            let name = format!("h{number}");
            match noise.bits() % 3 {
                0 => bone(&name, place(&mut noise), place(&mut noise)),
                1 => region(&name, &[(noise.bits() % mesh.vertex_count() as u64) as u32]),
                _ => point(&name, place(&mut noise)),
            }
        }).collect();
        let cage_edges = if count > 1 { vec![[0, 1]] } else { Vec::new() };
        match (HandleSet { handles, cage_edges }).attach(&mesh, &AttachOptions::default()) {
            Ok(attached) => {
                check_unity(&attached);
                prop_assert!(attached.vertices().iter().all(|list| !list.is_empty() && list.is_sorted()));
            }
            Err(error) => prop_assert!(matches!(
                error,
                HandleError::Shared { .. } | HandleError::CageEdge { .. } | HandleError::NoVertex { .. } | HandleError::Outside { .. }
            ), "{}", error),
        }
    }
}
