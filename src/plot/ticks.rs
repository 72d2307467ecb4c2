//! Round numbers for axes, isolines and labels.

/// The round number, 1, 2 or 5 times a power of ten, next above `rough`.
pub(super) fn round_step(rough: f64) -> f64 {
    if !(rough.is_finite() && rough > 0.0) {
        return 1.0;
    }
    let power = 10f64.powf(rough.log10().floor());
    let lead = [1.0, 2.0, 5.0, 10.0].into_iter().find(|lead| lead * power >= rough * (1.0 - 1e-9));
    lead.unwrap_or(10.0) * power
}

/// Multiples of a round step in `[low, high]`, at most about `count`, and their labels.
pub(super) fn ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let step = round_step((high - low) / count.max(1) as f64);
    // Steps too small for the size of the numbers cannot be told apart in their last digit.
    if step <= high.abs().max(low.abs()) * 1e-12 {
        return vec![(low, number(low))];
    }
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let largest = low.abs().max(high.abs());
    let mut ticks = Vec::new();
    let mut k = first;
    while k <= last {
        ticks.push((k * step, label(k * step, step, largest)));
        k += 1.0;
    }
    ticks
}

fn label(value: f64, step: f64, largest: f64) -> String {
    if !(1e-4..1e6).contains(&largest) {
        return number(value);
    }
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches(['-', '0', '.']).is_empty() { format!("{:.decimals$}", 0.0) } else { text }
}

/// A number in four significant digits, as short as it goes.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let shortened = |text: String| match text.split_once('.') {
        Some((whole, digits)) => match digits.trim_end_matches('0') {
            "" => whole.to_owned(),
            kept => format!("{whole}.{kept}"),
        },
        None => text,
    };
    let exponent = value.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) {
        return shortened(format!("{value:.*}", (3 - exponent).max(0) as usize));
    }
    let text = format!("{value:.3e}");
    match text.split_once('e') {
        Some((mantissa, power)) => format!("{}e{power}", shortened(mantissa.to_owned())),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 1.0, -2.5, 1424.3, 12345.6, 1e-7, 1.23456e9, 0.00123456].map(number);
        assert_eq!(texts, ["0", "1", "-2.5", "1424", "12346", "1e-7", "1.235e9", "0.001235"]);
    }

    #[test]
    fn ticks_lie_in_the_range_and_on_round_numbers() {
        let texts = |low, high| ticks(low, high, 5).into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(texts(0.0, 1424.0), ["0", "500", "1000"]);
        assert_eq!(texts(-0.3, 0.31), ["-0.2", "0.0", "0.2"]);
        assert_eq!(texts(1e9, 2e9).len(), 6);
        assert_eq!(texts(5.0, 5.0), ["5"]);
    }
}
