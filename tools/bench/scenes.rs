//! Deformations with known counts of elements: a quad with a moved disc, a swirl, a pinched ball, a bent bar.
//!
//! Shared by the benchmark, the test set and the tests.

use morsmooth::deform::{DeformError, DeformOptions, Deformer};
use morsmooth::field::VertexId;
use morsmooth::mesh::SimplicialComplex;
use morsmooth::operators::positive_laplacian;
use morsmooth::qp::{Engine, Objective, Problem, Term};

/// A mesh, what is held where, and the rotation of every element.
pub struct Scene {
    pub complex: SimplicialComplex,
    pub handles: Vec<VertexId>,
    pub targets: Vec<[f64; 3]>,
    pub rotations: Vec<[[f64; 3]; 3]>,
}

impl Scene {
    pub fn deformer(&self, options: DeformOptions) -> Deformer {
        Deformer::new(&self.complex, &self.handles, options).unwrap()
    }

    pub fn problem(&self, options: DeformOptions) -> Result<Problem, DeformError> {
        self.deformer(options).problem(&self.rotations, &self.targets)
    }
}

/// Rotation by an angle about the z axis.
pub fn turn(angle: f64) -> [[f64; 3]; 3] {
    let (sine, cosine) = angle.sin_cos();
    [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]
}

pub fn rotated(matrix: &[[f64; 3]; 3], point: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * point[0] + row[1] * point[1] + row[2] * point[2])
}

/// The unit square in `cells x cells` cells of four triangles each.
pub fn square(cells: usize) -> SimplicialComplex {
    let side = cells + 1;
    let step = 1.0 / cells as f64;
    let corner = |i: usize, j: usize| (j * side + i) as u32;
    let mut points: Vec<[f64; 3]> =
        (0..side * side).map(|p| [(p % side) as f64 * step, (p / side) as f64 * step, 0.0]).collect();
    let mut triangles = Vec::new();
    for j in 0..cells {
        for i in 0..cells {
            let centre = points.len() as u32;
            points.push([(i as f64 + 0.5) * step, (j as f64 + 0.5) * step, 0.0]);
            let ring = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            for side in 0..4 {
                triangles.extend([ring[side], ring[(side + 1) % 4], centre]);
            }
        }
    }
    SimplicialComplex::new(2, points, triangles).unwrap()
}

/// Boundary held, centre disc of a radius turned and moved; the angle of the rotations is harmonic between the two.
fn disc(cells: usize, radius: f64, degrees: f64, shift: [f64; 2]) -> Scene {
    let complex = square(cells);
    let angle = degrees.to_radians();
    let matrix = turn(angle);
    let (mut handles, mut targets) = (Vec::new(), Vec::new());
    let mut angles = vec![None; complex.vertex_count()];
    for (vertex, &point) in complex.points().iter().enumerate() {
        let from = [point[0] - 0.5, point[1] - 0.5, 0.0];
        let outer = point[..2].iter().any(|&part| part == 0.0 || (part - 1.0).abs() < 1e-12);
        if outer {
            handles.push(vertex.into());
            targets.push(point);
            angles[vertex] = Some(0.0);
        } else if from[0].hypot(from[1]) <= radius * (1.0 + 1e-9) {
            let to = rotated(&matrix, from);
            handles.push(vertex.into());
            targets.push([0.5 + to[0] + shift[0], 0.5 + to[1] + shift[1], 0.0]);
            angles[vertex] = Some(angle);
        }
    }
    let harmonic = Objective {
        terms: vec![Term::Matrix(positive_laplacian(&complex).unwrap())],
        linear: vec![0.0; complex.vertex_count()],
        constant: 0.0,
    };
    let angles = Engine::new(&harmonic, None, None).unwrap().minimise(&harmonic, &angles).unwrap().x;
    let mean = |corners: &[u32]| corners.iter().map(|&v| angles[v as usize]).sum::<f64>() / 3.0;
    let rotations = complex.simplices().chunks(3).map(|corners| turn(mean(corners))).collect();
    Scene { complex, handles, targets, rotations }
}

/// Centre disc of radius 0.15 moved by (0.2, 0.08) and turned by 60 degrees, `4 cells²` triangles.
pub fn quad(cells: usize) -> Scene {
    disc(cells, 0.15, 60.0, [0.2, 0.08])
}

/// Centre disc of radius 0.1 turned, `4 cells²` triangles.
pub fn swirl(cells: usize, degrees: f64) -> Scene {
    disc(cells, 0.1, degrees, [0.0; 2])
}

/// The cells of a grid of cubes with edge `step` for which `inside` is true, six tetrahedra each, and only their points.
pub fn solid(cells: [usize; 3], step: f64, inside: impl Fn([f64; 3]) -> bool) -> SimplicialComplex {
    let side = cells.map(|count| count + 1);
    let corner = |i: usize, j: usize, k: usize| (k * side[1] + j) * side[0] + i;
    let mut number = vec![u32::MAX; side.iter().product()];
    let (mut points, mut simplices) = (Vec::new(), Vec::new());
    for cell in 0..cells.iter().product() {
        let at = [cell % cells[0], cell / cells[0] % cells[1], cell / (cells[0] * cells[1])];
        if !inside(at.map(|place| (place as f64 + 0.5) * step)) {
            continue;
        }
        for axes in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let mut place = at;
            let mut tetrahedron = [0; 4];
            for (slot, next) in tetrahedron.iter_mut().zip([None, Some(axes[0]), Some(axes[1]), Some(axes[2])]) {
                if let Some(axis) = next {
                    place[axis] += 1;
                }
                let name: &mut u32 = &mut number[corner(place[0], place[1], place[2])];
                if *name == u32::MAX {
                    *name = points.len() as u32;
                    points.push(place.map(|part| part as f64 * step));
                }
                *slot = *name;
            }
            simplices.extend(tetrahedron);
        }
    }
    SimplicialComplex::new(3, points, simplices).unwrap()
}

/// Half the height of the ring and depth of the caps by which the ball is held, and the depth of the ring.
const LAYER: f64 = 0.035;
const RIM: f64 = 0.044;

/// A voxel ball of diameter 1, `cells` cubes across, whose equator is drawn in to 30 % of its radius.
pub fn ball(cells: usize) -> Scene {
    let step = 1.0 / cells as f64;
    let radius = |p: [f64; 3]| (p[0] - 0.5).hypot(p[1] - 0.5).hypot(p[2] - 0.5);
    let complex = solid([cells; 3], step, |p| radius(p) <= 0.5);
    // The same parts of the ball are held at every resolution, at least one layer of vertices.
    let (layer, rim) = ((0.6 * step).max(LAYER), (0.75 * step).max(RIM));
    let (mut handles, mut targets) = (Vec::new(), Vec::new());
    for (vertex, &p) in complex.points().iter().enumerate() {
        let axis = (p[0] - 0.5).hypot(p[1] - 0.5);
        let height = (p[2] - 0.5).abs();
        if height <= layer && axis >= 0.5 - rim {
            handles.push(vertex.into());
            targets.push([0.5 + 0.3 * (p[0] - 0.5), 0.5 + 0.3 * (p[1] - 0.5), p[2]]);
        } else if height >= 0.5 - layer {
            handles.push(vertex.into());
            targets.push(p);
        }
    }
    let identity = vec![turn(0.0); complex.simplex_count()];
    Scene { complex, handles, targets, rotations: identity }
}

/// A bar of `length x width x width` cubes and length 1 folded like a hinge by an angle; its ends, up to 0.2 from the middle, are
/// turned by half of it each about the middle, and so crush what is between them on the inner side.
pub fn bar(length: usize, width: usize, degrees: f64) -> Scene {
    const FREE: f64 = 0.2;
    let step = 1.0 / length as f64;
    let complex = solid([length, width, width], step, |_| true);
    let middle = [0.5, width as f64 * step / 2.0, 0.0];
    let angle = |x: f64| degrees.to_radians() * ((x - 0.5) / FREE).clamp(-1.0, 1.0) / 2.0;
    let (mut handles, mut targets) = (Vec::new(), Vec::new());
    for (vertex, &p) in complex.points().iter().enumerate() {
        if (p[0] - 0.5).abs() >= FREE - 1e-12 {
            let from = std::array::from_fn(|axis| p[axis] - middle[axis]);
            let to = rotated(&turn(angle(p[0])), from);
            targets.push(std::array::from_fn(|axis| middle[axis] + to[axis]));
            handles.push(vertex.into());
        }
    }
    let mean = |corners: &[u32]| corners.iter().map(|&v| complex.points()[v as usize][0]).sum::<f64>() / 4.0;
    let rotations = complex.simplices().chunks(4).map(|corners| turn(angle(mean(corners)))).collect();
    Scene { complex, handles, targets, rotations }
}

/// The bar of 10,800 tetrahedra, `50 x 6 x 6` cubes, and what is done to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// Ends turned against each other about the long axis by an angle.
    Twist(f64),
    /// Drawn to a multiple of its length, ends held.
    Stretch(f64),
}

/// A bar of `length x width x width` cubes and length 1 under a load; its ends, a tenth of its length each, are held.
pub fn rod(length: usize, width: usize, load: Load) -> Scene {
    const HELD: f64 = 0.1;
    let step = 1.0 / length as f64;
    let complex = solid([length, width, width], step, |_| true);
    let middle = width as f64 * step / 2.0;
    // From -1 at the one end to 1 at the other.
    let along = |x: f64| ((x - 0.5) / (0.5 - HELD)).clamp(-1.0, 1.0);
    let about = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        [[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]]
    };
    let rotation = |x: f64| match load {
        Load::Twist(degrees) => about(0.5 * degrees.to_radians() * along(x)),
        Load::Stretch(_) => about(0.0),
    };
    let (mut handles, mut targets) = (Vec::new(), Vec::new());
    for (vertex, &p) in complex.points().iter().enumerate() {
        if (p[0] - 0.5).abs() >= 0.5 - HELD - 1e-12 {
            let shift = if let Load::Stretch(factor) = load { 0.5 * (factor - 1.0) * along(p[0]) } else { 0.0 };
            let to = rotated(&rotation(p[0]), [p[0], p[1] - middle, p[2] - middle]);
            handles.push(vertex.into());
            targets.push([to[0] + shift, to[1] + middle, to[2] + middle]);
        }
    }
    let mean = |corners: &[u32]| corners.iter().map(|&v| complex.points()[v as usize][0]).sum::<f64>() / 4.0;
    let rotations = complex.simplices().chunks(4).map(|corners| rotation(mean(corners))).collect();
    Scene { complex, handles, targets, rotations }
}

/// The unit square at rest with its boundary held; one triangle in the middle is asked to turn by an angle.
pub fn lone(cells: usize, degrees: f64) -> Scene {
    let mut scene = quad(cells);
    scene.targets = scene.handles.iter().map(|vertex| scene.complex.points()[vertex.index()]).collect();
    let count = scene.complex.simplex_count();
    scene.rotations = vec![turn(0.0); count];
    scene.rotations[count / 2 + 1] = turn(degrees.to_radians());
    scene
}

/// The quad with every rotation drawn anew, evenly within an angle to either side.
pub fn shaken(cells: usize, degrees: f64, seed: u64) -> Scene {
    let mut scene = quad(cells);
    let mut state = seed;
    for rotation in &mut scene.rotations {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let even = ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        *rotation = turn(even * degrees.to_radians());
    }
    scene
}
