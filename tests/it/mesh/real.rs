//! Meshes made by others. Counts and measures were taken with numpy and PyVista from the same files.

use crate::support::shared;
use morsmooth::mesh::{CellList, CellShape, Domain, Mask, MeshFault, check, faults};
use morsmooth::operators::{cotangent_laplacian, lumped_mass};
use std::path::Path;

/// Points and triangles of a Wavefront or OFF file, or points and tetrahedra of a Medit file.
fn read(path: &Path) -> Domain {
    let text = std::fs::read_to_string(path).unwrap();
    let numbers = |line: &str| line.split_whitespace().filter_map(|word| word.parse().ok()).collect::<Vec<f64>>();
    let mut points = Vec::new();
    let mut corners = Vec::new();
    let extension = path.extension().unwrap().to_str().unwrap();
    let mut lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    match extension {
        "obj" => {
            for line in lines {
                let first = |word: &str| word.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                if let Some(rest) = line.strip_prefix("v ") {
                    points.push([0, 1, 2].map(|axis| numbers(rest)[axis]));
                } else if let Some(rest) = line.strip_prefix("f ") {
                    corners.extend(rest.split_whitespace().map(first));
                }
            }
        }
        "off" => {
            let counts = numbers(lines.by_ref().nth(1).unwrap());
            points.extend(lines.by_ref().take(counts[0] as usize).map(|line| [0, 1, 2].map(|axis| numbers(line)[axis])));
            corners.extend(lines.flat_map(|line| numbers(line).into_iter().skip(1)).map(|corner| corner as u32));
        }
        _ => {
            lines.by_ref().find(|line| line.trim() == "Vertices").unwrap();
            let count = numbers(lines.next().unwrap())[0] as usize;
            points.extend(lines.by_ref().take(count).map(|line| [0, 1, 2].map(|axis| numbers(line)[axis])));
            lines.by_ref().find(|line| line.trim() == "Tetrahedra").unwrap();
            let count = numbers(lines.next().unwrap())[0] as usize;
            corners.extend(lines.take(count).flat_map(|line| [0, 1, 2, 3].map(|corner| numbers(line)[corner] as u32 - 1)));
        }
    }
    let (shape, stride) = if extension == "mesh" { (CellShape::Tetrahedron, 4) } else { (CellShape::Triangle, 3) };
    Domain::from_cells(&points, &CellList::uniform(shape, stride, &corners), &Mask::none()).unwrap()
}

#[test]
fn counts_and_measures_agree_with_numpy_and_pyvista() {
    // File, vertices, edges, top simplices, measure.
    for (name, vertices, edges, simplices, measure) in [
        ("surfaces/beetle.off", 19887, 58552, 38656, 0.6482219130839343),
        ("surfaces/camelhead.off", 11381, 34084, 22704, 1.3032363673225258),
        ("surfaces/fish_low_resolution.obj", 945, 2829, 1886, 8.154720435326723),
        ("surfaces/skull.obj", 49999, 150003, 100002, 501.61859098099126),
        ("surfaces/spot.obj", 11533, 34593, 23062, 5.576967476274539),
        ("tets/bunny.mesh", 5433, 39822, 34055, 0.0012494148176858352),
        ("tets/hand.mesh", 7234, 42009, 29998, 0.160465575988793),
        ("tets/cactus_3d.mesh", 5531, 25374, 14585, 0.011290326469236549),
        ("tets/octopus-low.mesh", 452, 2040, 1140, 0.009135547847518202),
    ] {
        let Some(path) = shared(name) else { continue };
        let domain = read(&path);
        let complex = &domain.complex;
        assert_eq!((complex.vertex_count(), complex.edges().len(), complex.simplex_count()), (vertices, edges, simplices), "{name}");
        assert_eq!(check(&domain), Ok(()), "{name}");
        let mass: f64 = lumped_mass(complex).unwrap().iter().sum();
        assert!((mass - measure).abs() < 1e-9 * measure, "{name}: {mass}");
        // The gradients of the coordinates are an identity matrix on every simplex.
        let laplacian = cotangent_laplacian(complex).unwrap();
        let energy = |axis: usize| {
            let x: Vec<f64> = complex.points().iter().map(|point| point[axis]).collect();
            laplacian.multiply(&x).iter().zip(&x).map(|(a, b)| a * b).sum::<f64>()
        };
        let whole = complex.dimension() as f64 * measure;
        // Large weights of slivers cancel: the rounding of one is about eps over its ratio (1.4e-8 in the bunny).
        let thinnest = (0..simplices).map(|simplex| complex.measure_ratio(simplex)).fold(1.0, f64::min);
        let error = ((0..3).map(energy).sum::<f64>() - whole).abs() / whole;
        assert!(error < 1e-12 + 10.0 * f64::EPSILON / thinnest, "{name}: {error:e} at {thinnest:e}");
        let found = faults(&domain);
        if name.contains("beetle") {
            assert!(found.iter().any(|fault| matches!(fault, MeshFault::DuplicatePoints { count: 2, .. })), "{found:?}");
        }
        assert!(!found.iter().any(|f| matches!(f, MeshFault::NonManifoldEdge { .. } | MeshFault::NonManifoldFace { .. })));
    }
}
