//! From cells and grids to a domain: checks, mask, subdivision, renumbering.

use super::complex::check_size;
use super::incidence::{self, Star};
use super::subdivide::subdivide;
use super::{CellList, CellShape, Domain, DomainError, Grid, Mask, MeshFault, SimplicialComplex};
use crate::field::VertexId;
use rayon::prelude::*;

/// Cells handled by one parallel task. Any size gives the same result.
const CHUNK: usize = 8192;

/// Simplices in the numbering of the points, and the cell of each.
#[derive(Default)]
struct Pieces {
    simplices: Vec<u32>,
    cells: Vec<u32>,
}

pub(super) fn from_cells(points: &[[f64; 3]], cells: &CellList, mask: &Mask) -> Result<Domain, DomainError> {
    check_mask(mask, points.len(), cells.len())?;
    check_cells(points.len(), cells, mask)?;
    let kept = |cell: usize| keeps(&mask.keep_cells, cell);
    let dimension = (0..cells.len()).filter(|&cell| kept(cell)).filter_map(|cell| cells.shapes[cell].dimension()).max();
    let Some(dimension) = dimension.filter(|&dimension| dimension > 0) else {
        return Err(empty(points.len(), cells.len(), mask));
    };
    let parts: Vec<(Pieces, CellRemarks)> = (0..cells.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut pieces = Pieces::default();
            let mut remarks = CellRemarks::default();
            let mut corners = Vec::new();
            for cell in (chunk * CHUNK..cells.len().min((chunk + 1) * CHUNK)).filter(|&cell| kept(cell)) {
                let shape = cells.shapes[cell];
                if shape.dimension() != Some(dimension) {
                    remarks.lower.add(cell);
                    continue;
                }
                corners.clear();
                let remark = subdivide(shape, cells.corners(cell), points, &mut corners);
                remarks.collapsed.add_if(remark.collapsed, cell);
                remarks.tangled.add_if(remark.tangled, cell);
                pieces.push_kept(&corners, dimension + 1, cell, mask);
            }
            (pieces, remarks)
        })
        .collect();
    let mut remarks = CellRemarks::default();
    for (_, part) in &parts {
        remarks.join(part);
    }
    let mut referenced = vec![false; points.len()];
    for &point in &cells.connectivity {
        referenced[point as usize] = true;
    }
    let pieces = Pieces::join(parts.into_iter().map(|(pieces, _)| pieces).collect());
    let input = Input { points: points.len(), cells: cells.len(), mask, referenced: Some(referenced), dimension };
    let mut domain = assemble(&input, pieces, |point| points[point])?;
    domain.notes.extend(remarks.into_faults(dimension));
    Ok(domain)
}

pub(super) fn from_grid(grid: &Grid, mask: &Mask) -> Result<Domain, DomainError> {
    grid.check()?;
    let (points, cells, dimension) = (grid.point_count(), grid.cell_count(), grid.dimension());
    check_mask(mask, points, cells)?;
    if dimension == 0 || points == 0 {
        return Err(empty(points, cells, mask));
    }
    let offsets = grid.cell_simplices();
    let parts: Vec<Pieces> = (0..cells.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut pieces = Pieces::default();
            for cell in (chunk * CHUNK..cells.min((chunk + 1) * CHUNK)).filter(|&cell| keeps(&mask.keep_cells, cell)) {
                let first = grid.cell_origin(cell);
                for simplex in &offsets {
                    let mut corners = [0; 4];
                    for (corner, offset) in corners.iter_mut().zip(simplex) {
                        *corner = first + offset;
                    }
                    pieces.push_kept(&corners[..=dimension], dimension + 1, cell, mask);
                }
            }
            pieces
        })
        .collect();
    let input = Input { points, cells, mask, referenced: None, dimension };
    assemble(&input, Pieces::join(parts), |point| grid.point(point))
}

pub(super) fn from_complex(complex: &SimplicialComplex) -> Result<Domain, DomainError> {
    let (points, cells) = (complex.vertex_count(), complex.simplex_count());
    let mask = Mask::none();
    let pieces = Pieces { simplices: complex.simplices().to_vec(), cells: (0..cells as u32).collect() };
    // A vertex that no simplex uses is named by no cell.
    let input = Input { points, cells, mask: &mask, referenced: Some(vec![false; points]), dimension: complex.dimension() };
    assemble(&input, pieces, |point| complex.points()[point])
}

impl Pieces {
    /// Appends the simplices of a cell whose points the mask keeps.
    fn push_kept(&mut self, simplices: &[u32], stride: usize, cell: usize, mask: &Mask) {
        for simplex in simplices.chunks_exact(stride) {
            if simplex.iter().all(|&point| keeps(&mask.keep_points, point as usize)) {
                self.simplices.extend_from_slice(simplex);
                self.cells.push(cell as u32);
            }
        }
    }

    fn join(parts: Vec<Self>) -> Self {
        let mut all = Self::default();
        all.simplices.reserve(parts.iter().map(|part| part.simplices.len()).sum());
        all.cells.reserve(parts.iter().map(|part| part.cells.len()).sum());
        for part in parts {
            all.simplices.extend_from_slice(&part.simplices);
            all.cells.extend_from_slice(&part.cells);
        }
        all
    }
}

/// What `assemble` must know of the input.
struct Input<'a> {
    points: usize,
    cells: usize,
    mask: &'a Mask,
    /// Whether any cell names the point; `None` if all are named.
    referenced: Option<Vec<bool>>,
    dimension: usize,
}

/// Renumbers the used points, drops repeated simplices, builds the complex.
fn assemble(
    input: &Input,
    mut pieces: Pieces,
    position: impl Fn(usize) -> [f64; 3] + Sync,
) -> Result<Domain, DomainError> {
    if pieces.cells.is_empty() {
        return Err(empty(input.points, input.cells, input.mask));
    }
    check_size("points", input.points)?;
    check_size("corners of simplices", pieces.simplices.len())?;
    let mut used = vec![false; input.points];
    for &point in &pieces.simplices {
        used[point as usize] = true;
    }
    let point_of_vertex: Vec<u32> = (0..input.points as u32).filter(|&point| used[point as usize]).collect();
    let mut vertex_of_point = vec![None; input.points];
    for (vertex, &point) in point_of_vertex.iter().enumerate() {
        vertex_of_point[point as usize] = Some(VertexId::from(vertex));
    }
    if point_of_vertex.len() < input.points {
        pieces.simplices.par_iter_mut().with_min_len(CHUNK).for_each(|corner| {
            *corner = vertex_of_point[*corner as usize].map_or(*corner, |vertex| vertex.0);
        });
    }
    let points: Vec<[f64; 3]> =
        point_of_vertex.par_iter().with_min_len(CHUNK).map(|&point| position(point as usize)).collect();
    let broken = points.par_iter().with_min_len(CHUNK).position_first(|point| point.iter().any(|part| !part.is_finite()));
    if let Some(vertex) = broken {
        return Err(DomainError::NonFinitePoint { point: point_of_vertex[vertex], coordinates: points[vertex] });
    }
    let mut notes = left_out_points(input, &used);
    let (star, repeated) = drop_duplicates(points.len(), input.dimension + 1, &mut pieces);
    notes.extend(repeated);
    let complex = SimplicialComplex::from_star(input.dimension, points, pieces.simplices, star)?;
    Ok(Domain { complex, vertex_of_point, point_of_vertex, cell_of_simplex: pieces.cells, notes })
}

/// Points that the mask keeps but the domain does not use.
fn left_out_points(input: &Input, used: &[bool]) -> Vec<MeshFault> {
    let (mut unreferenced, mut isolated) = (Tally::default(), Tally::default());
    for point in (0..input.points).filter(|&point| !used[point] && keeps(&input.mask.keep_points, point)) {
        let referenced = input.referenced.as_ref().is_none_or(|referenced| referenced[point]);
        unreferenced.add_if(!referenced, point);
        isolated.add_if(referenced, point);
    }
    let unreferenced = unreferenced.fault(|count, first| MeshFault::UnreferencedPoints { count, first });
    let isolated = isolated.fault(|count, first| MeshFault::IsolatedPoints { count, first });
    unreferenced.into_iter().chain(isolated).collect()
}

/// Keeps the first of every set of simplices with the same vertices.
fn drop_duplicates(vertices: usize, stride: usize, pieces: &mut Pieces) -> (Star, Option<MeshFault>) {
    let star = Star::new(vertices, stride, &pieces.simplices);
    let mut pairs = incidence::duplicates(&star, stride, &pieces.simplices);
    if pairs.is_empty() {
        return (star, None);
    }
    pairs.sort_unstable_by_key(|&(_, later)| later);
    let mut repeated = vec![false; pieces.cells.len()];
    for &(_, later) in &pairs {
        repeated[later as usize] = true;
    }
    let mut cells: Vec<u32> = pairs.iter().map(|&(_, later)| pieces.cells[later as usize]).collect();
    cells.dedup();
    let [first, second] = [pairs[0].0, pairs[0].1].map(|simplex| pieces.cells[simplex as usize]);
    let note = MeshFault::DuplicateCells { count: cells.len(), first, second };
    let mut kept = Pieces::default();
    for (simplex, corners) in pieces.simplices.chunks_exact(stride).enumerate() {
        if !repeated[simplex] {
            kept.simplices.extend_from_slice(corners);
            kept.cells.push(pieces.cells[simplex]);
        }
    }
    *pieces = kept;
    (Star::new(vertices, stride, &pieces.simplices), Some(note))
}

/// How many, and the first.
#[derive(Default, Clone, Copy)]
struct Tally {
    count: usize,
    first: Option<u32>,
}

impl Tally {
    fn add(&mut self, place: usize) {
        self.add_if(true, place);
    }

    fn add_if(&mut self, condition: bool, place: usize) {
        if condition {
            self.count += 1;
            self.first.get_or_insert(place as u32);
        }
    }

    fn join(&mut self, later: Self) {
        self.count += later.count;
        self.first = self.first.or(later.first);
    }

    fn fault(self, fault: impl FnOnce(usize, u32) -> MeshFault) -> Option<MeshFault> {
        self.first.map(|first| fault(self.count, first))
    }
}

#[derive(Default)]
struct CellRemarks {
    lower: Tally,
    collapsed: Tally,
    tangled: Tally,
}

impl CellRemarks {
    fn join(&mut self, later: &Self) {
        self.lower.join(later.lower);
        self.collapsed.join(later.collapsed);
        self.tangled.join(later.tangled);
    }

    fn into_faults(self, dimension: usize) -> impl Iterator<Item = MeshFault> {
        let lower = self.lower.fault(|count, first| MeshFault::LowerDimensionalCells { count, first, dimension });
        let collapsed = self.collapsed.fault(|count, first| MeshFault::CollapsedCells { count, first });
        let tangled = self.tangled.fault(|count, first| MeshFault::TangledPolygons { count, first });
        lower.into_iter().chain(collapsed).chain(tangled)
    }
}

fn keeps(flags: &Option<Vec<bool>>, place: usize) -> bool {
    flags.as_ref().is_none_or(|flags| flags[place])
}

fn empty(points: usize, cells: usize, mask: &Mask) -> DomainError {
    let dropped = |flags: &Option<Vec<bool>>| flags.as_ref().map_or(0, |flags| flags.iter().filter(|&&keep| !keep).count());
    DomainError::Empty { points, cells, masked_points: dropped(&mask.keep_points), masked_cells: dropped(&mask.keep_cells) }
}

fn check_mask(mask: &Mask, points: usize, cells: usize) -> Result<(), DomainError> {
    for (what, flags, expected) in [("points", &mask.keep_points, points), ("cells", &mask.keep_cells, cells)] {
        match flags {
            Some(flags) if flags.len() != expected => {
                return Err(DomainError::MaskLength { what, expected, found: flags.len() });
            }
            _ => {}
        }
    }
    Ok(())
}

/// Refuses cell lists that contradict themselves, and kept cells that cannot be subdivided.
fn check_cells(points: usize, cells: &CellList, mask: &Mask) -> Result<(), DomainError> {
    let offsets = &cells.offsets;
    let wrong = |cell: usize, found: String, expected: String| Err(DomainError::Offsets { cell, found, expected });
    if offsets.len() != cells.len() + 1 {
        return wrong(0, format!("{} offsets", offsets.len()), format!("{} for {} cells", cells.len() + 1, cells.len()));
    }
    if offsets[0] != 0 {
        return wrong(0, format!("first offset {}", offsets[0]), "0".into());
    }
    if let Some(cell) = offsets.windows(2).position(|ends| ends[0] > ends[1]) {
        let (begin, end) = (offsets[cell], offsets[cell + 1]);
        return wrong(cell, format!("end {end}"), format!("at least its begin {begin}"));
    }
    let (end, corners) = (offsets[cells.len()] as usize, cells.connectivity.len());
    if end != corners {
        return wrong(cells.len().saturating_sub(1), format!("end {end}"), format!("the {corners} corners there are"));
    }
    let outside = cells.connectivity.par_iter().with_min_len(CHUNK).position_first(|&point| point as usize >= points);
    if let Some(position) = outside {
        let cell = offsets.partition_point(|&end| end as usize <= position) - 1;
        return Err(DomainError::PointOutOfRange { cell, point: cells.connectivity[position], points });
    }
    let fault = |cell: usize| {
        let (shape, found) = (cells.shapes[cell], cells.corners(cell).len());
        match (shape, shape.corner_count()) {
            _ if !keeps(&mask.keep_cells, cell) => None,
            // VTK's empty cell is no cell of an unknown shape but no cell.
            (CellShape::Other(0), _) => None,
            (CellShape::Other(vtk_type), _) => Some(DomainError::UnsupportedCell { cell, vtk_type }),
            (_, Some(expected)) if expected != found => Some(DomainError::CornerCount { cell, shape, expected, found }),
            _ => None,
        }
    };
    (0..cells.len()).into_par_iter().with_min_len(CHUNK).find_map_first(fault).map_or(Ok(()), Err)
}
