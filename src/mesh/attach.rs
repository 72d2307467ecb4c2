//! Finding the vertices that carry handles.

use super::handles::{AttachedHandles, Handle, HandleSet, HandleShape, SharedVertex};
use super::segment::{self, Reach};
use super::{HandleError, SimplicialComplex};
use crate::field::VertexId;
use std::collections::BTreeMap;

/// How far handles may be from the vertices that carry them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttachOptions {
    /// Greatest distance of a place from its vertex, as a fraction of the bounding-box diagonal; never less than the longest edge at
    /// that vertex, so that every place inside the mesh is within reach.
    pub reach: f64,
    /// Vertices this close to a bone or cage edge lie on it; a fraction of the bounding-box diagonal.
    pub on_segment: f64,
}

impl Default for AttachOptions {
    /// 2 % and 0.01 %.
    fn default() -> Self {
        Self { reach: 0.02, on_segment: 1e-4 }
    }
}

/// What handles ask of one vertex, before it is settled who gets it.
type Claims = BTreeMap<VertexId, Vec<(usize, f64)>>;

pub(super) fn attach(
    set: &HandleSet,
    complex: &SimplicialComplex,
    options: &AttachOptions,
) -> Result<AttachedHandles, HandleError> {
    check_set(set)?;
    check_vertices(complex)?;
    let diagonal = complex.bounding_box_diagonal();
    let reach = Reach { outside: options.reach * diagonal, on: options.on_segment * diagonal };
    let mut claims = Claims::new();
    for (place, handle) in set.handles.iter().enumerate() {
        for vertex in carriers(handle, complex, reach)? {
            claims.entry(vertex).or_default().push((place, 1.0));
        }
    }
    check_claims(set, complex, &claims)?;
    claim_cage(set, complex, reach, &mut claims)?;
    let attached = settle(set, claims)?;
    check_parts(complex, &attached)?;
    Ok(attached)
}

/// The vertices that carry one handle, rising.
fn carriers(handle: &Handle, complex: &SimplicialComplex, reach: Reach) -> Result<Vec<VertexId>, HandleError> {
    let name = &handle.name;
    let mut vertices = match &handle.shape {
        HandleShape::Point(point) => vec![nearest(name, *point, complex, reach)?],
        HandleShape::Bone(ends) => segment::along(name, *ends, complex, reach)?.into_iter().map(|(vertex, _)| vertex).collect(),
        HandleShape::Region(vertices) => {
            check_region(name, vertices, complex)?;
            vertices.clone()
        }
    };
    vertices.sort_unstable();
    vertices.dedup();
    Ok(vertices)
}

/// The vertex nearest to a place.
fn nearest(name: &str, place: [f64; 3], complex: &SimplicialComplex, reach: Reach) -> Result<VertexId, HandleError> {
    let all = (0..complex.vertex_count()).map(VertexId::from);
    match segment::nearest(complex, all, place) {
        Some((vertex, distance)) => {
            let allowed = reach.outside.max(segment::longest_edge(complex, vertex));
            if distance > allowed {
                return Err(HandleError::Outside { name: name.into(), place, vertex, distance, allowed });
            }
            Ok(vertex)
        }
        None => Err(HandleError::NoVertex { name: name.into(), reason: "the mesh has no vertices".into() }),
    }
}

/// Adds the vertices of cage edges, each shared by the two ends by its place between them.
fn claim_cage(
    set: &HandleSet,
    complex: &SimplicialComplex,
    reach: Reach,
    claims: &mut Claims,
) -> Result<(), HandleError> {
    let owned: Vec<(VertexId, usize)> = claims.iter().map(|(&vertex, claim)| (vertex, claim[0].0)).collect();
    let vertex_of = |handle: usize| owned.iter().find(|&&(_, owner)| owner == handle).map(|&(vertex, _)| vertex);
    for &[first, second] in &set.cage_edges {
        let (Some(start), Some(end)) = (vertex_of(first), vertex_of(second)) else { continue };
        // Between the vertices that carry the ends, so that values are linear on the mesh itself.
        let ends = [complex.point(start), complex.point(end)];
        let names = [first, second].map(|handle| &set.handles[handle].name);
        let label = format!("{}-{}", names[0], names[1]);
        for (vertex, share) in segment::along(&label, ends, complex, reach)? {
            if vertex == start || vertex == end {
                continue;
            }
            if let Ok(place) = owned.binary_search_by_key(&vertex, |&(vertex, _)| vertex) {
                let owner = set.handles[owned[place].1].name.clone();
                let place = complex.point(vertex);
                return Err(HandleError::Shared { first: format!("cage edge {label}"), second: owner, vertex, place });
            }
            let claim = claims.entry(vertex).or_default();
            claim.extend([(first, 1.0 - share), (second, share)].into_iter().filter(|&(_, share)| share > 0.0));
        }
    }
    Ok(())
}

/// Gives every vertex to its handle, or shares it out: shares of one vertex sum to 1.
fn settle(set: &HandleSet, claims: Claims) -> Result<AttachedHandles, HandleError> {
    let mut vertices = vec![Vec::new(); set.len()];
    let mut shared = Vec::new();
    for (vertex, mut claim) in claims {
        if let [(owner, _)] = claim[..] {
            vertices[owner].push(vertex);
            continue;
        }
        claim.sort_by_key(|&(owner, _)| owner);
        let total: f64 = claim.iter().map(|&(_, share)| share).sum();
        let mut shares: Vec<(usize, f64)> = Vec::new();
        for (owner, share) in claim {
            match shares.last_mut() {
                Some((last, sum)) if *last == owner => *sum += share / total,
                _ => shares.push((owner, share / total)),
            }
        }
        shared.push(SharedVertex { vertex, shares });
    }
    if let Some(empty) = vertices.iter().position(Vec::is_empty) {
        let reason = "every vertex along it belongs to a joint with another bone; refine the mesh or lengthen the bone".into();
        return Err(HandleError::NoVertex { name: set.handles[empty].name.clone(), reason });
    }
    Ok(AttachedHandles::new(set.names(), vertices, shared))
}

fn check_set(set: &HandleSet) -> Result<(), HandleError> {
    if set.is_empty() {
        return Err(HandleError::None);
    }
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for (second, Handle { name, shape }) in set.handles.iter().enumerate() {
        if let Some(first) = seen.insert(name, second) {
            return Err(HandleError::DuplicateName { name: name.clone(), first, second });
        }
        let places: &[[f64; 3]] = match shape {
            HandleShape::Point(point) => std::slice::from_ref(point),
            HandleShape::Bone(ends) => ends,
            HandleShape::Region(_) => &[],
        };
        if let Some(&place) = places.iter().find(|place| !place.iter().all(|part| part.is_finite())) {
            return Err(HandleError::NotFinite { name: name.clone(), place });
        }
        if let HandleShape::Bone([root, tip]) = shape
            && root == tip
        {
            return Err(HandleError::NoLength { name: name.clone(), place: *root });
        }
    }
    for (edge, &[first, second]) in set.cage_edges.iter().enumerate() {
        let is_point = |end: usize| matches!(set.handles.get(end), Some(Handle { shape: HandleShape::Point(_), .. }));
        if first == second || !is_point(first) || !is_point(second) {
            let describe = |end: usize| match set.handles.get(end) {
                Some(Handle { name, shape: HandleShape::Point(_) }) => format!("point \"{name}\""),
                Some(Handle { name, shape: HandleShape::Bone(_) }) => format!("bone \"{name}\""),
                Some(Handle { name, shape: HandleShape::Region(_) }) => format!("region \"{name}\""),
                None => format!("handle {end} of {}", set.len()),
            };
            return Err(HandleError::CageEdge { edge, first: describe(first), second: describe(second) });
        }
    }
    Ok(())
}

pub(super) fn check_region(name: &str, vertices: &[VertexId], complex: &SimplicialComplex) -> Result<(), HandleError> {
    if vertices.is_empty() {
        return Err(HandleError::NoVertex { name: name.into(), reason: "its list of vertices is empty".into() });
    }
    let count = complex.vertex_count();
    match vertices.iter().find(|vertex| vertex.index() >= count) {
        Some(&vertex) => Err(HandleError::VertexOutOfRange { name: name.into(), vertex, vertices: count }),
        None => Ok(()),
    }
}

fn check_vertices(complex: &SimplicialComplex) -> Result<(), HandleError> {
    let all = (0..complex.vertex_count()).map(VertexId::from);
    let mut lonely = all.filter(|&vertex| complex.star(vertex).is_empty());
    match lonely.next() {
        Some(vertex) => {
            Err(HandleError::Unreferenced { vertex, place: complex.point(vertex), count: 1 + lonely.count() })
        }
        None => Ok(()),
    }
}

/// Refuses a vertex that two handles claim, unless both are bones that meet in a joint.
fn check_claims(set: &HandleSet, complex: &SimplicialComplex, claims: &Claims) -> Result<(), HandleError> {
    for (&vertex, claim) in claims {
        for (place, &(first, _)) in claim.iter().enumerate() {
            for &(second, _) in &claim[place + 1..] {
                if !meet(&set.handles[first].shape, &set.handles[second].shape) {
                    let [first, second] = [first, second].map(|handle| set.handles[handle].name.clone());
                    return Err(HandleError::Shared { first, second, vertex, place: complex.point(vertex) });
                }
            }
        }
    }
    Ok(())
}

/// Whether two shapes are bones with a common end.
fn meet(first: &HandleShape, second: &HandleShape) -> bool {
    let (HandleShape::Bone(first), HandleShape::Bone(second)) = (first, second) else { return false };
    first.iter().any(|end| second.contains(end))
}

fn check_parts(complex: &SimplicialComplex, attached: &AttachedHandles) -> Result<(), HandleError> {
    let (part_of, parts) = complex.components();
    let mut held = vec![false; parts];
    for vertex in attached.vertices().iter().flatten() {
        held[part_of[vertex.index()] as usize] = true;
    }
    let Some(part) = held.iter().position(|held| !held) else { return Ok(()) };
    let mut members = (0..part_of.len()).filter(|&vertex| part_of[vertex] as usize == part);
    let vertex = VertexId::from(members.next().unwrap_or(0));
    Err(HandleError::PartWithoutHandle { vertex, place: complex.point(vertex), vertices: 1 + members.count(), parts })
}
