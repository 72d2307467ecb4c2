//! Data that a function made by hand stays close to.

use morsmooth::interpolate::Nearness;
use morsmooth::io::ArrayData;
use morsmooth::morse::{Selection, Threshold};
use morsmooth::smooth::{LengthReport, SelectOn, SmoothOptions, Smoother};
use serde_json::{Value, json};

use crate::args::MethodKind;
use crate::common::input::FieldInput;
use crate::common::number::short;
use crate::common::talk::Talk;
use crate::failure::Failure;
use crate::functions::interpolate::InterpolateArgs;

/// An array on the vertices, and how closely it is followed.
pub struct Data {
    name: String,
    /// Where there is none, the mean of the others, without confidence.
    values: Vec<f64>,
    /// 0 where there is no value; absent where there is one everywhere.
    confidence: Option<Vec<f64>>,
    length: LengthReport,
}

impl Data {
    /// The array that was asked for, if any.
    pub fn of(args: &InterpolateArgs, input: &FieldInput, talk: &Talk) -> Result<Option<Self>, Failure> {
        let Some(name) = &args.data else {
            let given = args.length.length.is_some() || args.length.length_abs.is_some();
            return match given {
                true => Err(Failure::usage("found a smoothing length without data; expected --data NAME with it")),
                false => Ok(None),
            };
        };
        if args.method != MethodKind::Monotone {
            let text = format!("found --data with --method {}; expected --method monotone", args.method.method());
            return Err(Failure::usage(text));
        }
        let file = |text: String| Failure::file(&input.path, text);
        let Some(array) = input.dataset.point_array(name) else {
            let known: Vec<&str> = input.dataset.point_data.arrays.iter().map(|array| array.name.as_str()).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            return Err(file(format!("found no point array '{name}'; expected the data")).hint(format!("point arrays: {known}")));
        };
        if array.components != 1 || matches!(array.data, ArrayData::String(_)) {
            return Err(file(format!("array '{name}' has {} components; expected one number a point", array.components)));
        }
        let mut values = input.domain.restrict(&array.to_f64(0));
        if let Some(vertex) = values.iter().position(|value| value.is_infinite()) {
            let point = input.domain.point_of_vertex()[vertex];
            return Err(file(format!("array '{name}' is {} at point {point}; expected a number, or NaN for none", values[vertex])));
        }
        let known: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
        if known.is_empty() {
            return Err(file(format!("array '{name}' has no value in the domain; expected some")));
        }
        let confidence = (known.len() < values.len()).then(|| values.iter().map(|value| f64::from(u8::from(!value.is_nan()))).collect());
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        values.iter_mut().filter(|value| value.is_nan()).for_each(|value| *value = mean);
        let length = length(args, input, (&values, confidence.as_deref()), talk)?;
        Ok(Some(Self { name: name.clone(), values, confidence, length }))
    }

    /// As the library takes it.
    pub fn nearness(&self) -> Nearness<'_> {
        Nearness { data: &self.values, length: self.length.absolute, confidence: self.confidence.as_deref() }
    }

    /// Root mean square distance from the data, over the vertices that have some.
    fn distance(&self, values: &[f64]) -> f64 {
        let weight = |vertex: usize| self.confidence.as_ref().map_or(1.0, |confidence| confidence[vertex]);
        let squares: f64 = (0..values.len()).map(|vertex| weight(vertex) * (values[vertex] - self.values[vertex]).powi(2)).sum();
        (squares / (0..values.len()).map(weight).sum::<f64>()).sqrt()
    }

    /// For a report.
    pub fn told(&self, values: &[f64]) -> Value {
        let without = self.confidence.as_ref().map_or(0, |confidence| confidence.iter().filter(|value| **value == 0.0).count());
        json!({ "array": self.name, "length": self.length, "without_value": without, "rms_distance": self.distance(values) })
    }

    /// For people.
    pub fn line(&self, values: &[f64]) -> String {
        let length = &self.length;
        format!(
            "{}, length {} ({:.2} % of the diagonal); root mean square distance {}",
            self.name,
            short(length.absolute),
            100.0 * length.of_diagonal,
            short(self.distance(values))
        )
    }
}

/// The smoothing length, as `smooth` chooses it.
fn length(
    args: &InterpolateArgs,
    input: &FieldInput,
    (values, confidence): (&[f64], Option<&[f64]>),
    talk: &Talk,
) -> Result<LengthReport, Failure> {
    talk.stage("smoothing length");
    let options = SmoothOptions {
        select_on: SelectOn::Smooth,
        order: usize::from(args.order),
        length: args.length.length(),
        confidence,
        // No selection is made; any would do.
        ..SmoothOptions::new(Selection::Threshold(Threshold::Fraction(0.0)))
    };
    let told = |error: morsmooth::smooth::SmoothError| input.smooth_failure(&error);
    let mut smoother = Smoother::new(&input.domain.complex, options.order).map_err(told)?;
    Ok(smoother.measured(values, &options, &mut |step| talk.progress(&step)).map_err(told)?.1)
}
