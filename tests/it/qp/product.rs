//! Values and gradients in product form against the formed matrix and finite differences.

use morsmooth::qp::{Objective, Term};

use super::path_laplacian;
use super::problems::Random;

fn objective(order: usize) -> Objective {
    let n = 12;
    let mut random = Random(3);
    let weights = (0..n).map(|i| if i == 5 { 0.0 } else { 0.5 + random.unit() }).collect();
    Objective {
        terms: vec![
            Term::Chain { scale: 0.7, stiffness: path_laplacian(n), weights, order },
            Term::Diagonal((0..n).map(|_| random.unit()).collect()),
            Term::Matrix(path_laplacian(n)),
        ],
        linear: (0..n).map(|_| random.normal()).collect(),
        constant: 0.3,
    }
}

/// The product of the chain, formed.
fn formed_gradient(objective: &Objective, x: &[f64]) -> Vec<f64> {
    let mut gradient = objective.linear.clone();
    for term in &objective.terms {
        let image = match term {
            Term::Matrix(matrix) => matrix.multiply(x),
            Term::Diagonal(diagonal) => diagonal.iter().zip(x).map(|(d, x)| d * x).collect(),
            Term::Chain { scale, stiffness, weights, order } => {
                let mut product = stiffness.clone();
                for _ in 1..*order {
                    product = stiffness.weighted_product(weights, &product);
                }
                product.multiply(x).iter().map(|y| scale * y).collect()
            }
        };
        gradient.iter_mut().zip(image).for_each(|(g, y)| *g += y);
    }
    gradient
}

#[test]
fn gradients_agree_with_the_formed_matrix() {
    for order in 1..=5 {
        let objective = objective(order);
        let mut random = Random(order as u64);
        let x: Vec<f64> = (0..12).map(|_| random.normal()).collect();
        let mut gradient = vec![0.0; 12];
        objective.gradient_into(&x, &mut gradient);
        // The norm of the path's Laplacian is below 4, the weights below 1.5.
        let room = 50.0 * f64::EPSILON * 4.0 * 6.0f64.powi(order as i32 - 1) * 10.0;
        assert!(gradient.iter().zip(formed_gradient(&objective, &x)).all(|(a, b)| (a - b).abs() <= room));
    }
}

#[test]
fn values_are_the_integral_of_the_gradient() {
    for order in 1..=5 {
        let objective = objective(order);
        let mut random = Random(40 + order as u64);
        let x: Vec<f64> = (0..12).map(|_| random.normal()).collect();
        let mut gradient = vec![0.0; 12];
        objective.gradient_into(&x, &mut gradient);
        // For a quadratic: f(x) = c + q.x / 2 + gradient.x / 2.
        let known = objective.constant
            + 0.5 * gradient.iter().zip(&objective.linear).zip(&x).map(|((g, q), x)| (g + q) * x).sum::<f64>();
        assert!((objective.value(&x) - known).abs() < 1e-12 * known.abs().max(1.0) * 6.0f64.powi(order as i32));
    }
}

#[test]
fn constants_have_no_energy_at_all() {
    for order in 1..=4 {
        let chain = Term::Chain { scale: 3.0, stiffness: path_laplacian(9), weights: vec![0.1; 9], order };
        let objective = Objective { terms: vec![chain], linear: vec![0.0; 9], constant: 0.0 };
        assert_eq!(objective.value(&[0.3; 9]), 0.0);
    }
}
