//! `simulator._core.LikelihoodField`: scoring and matching of scans.

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::slam::correlative::Window;
use crate::slam::likelihood_field::LikelihoodField;

/// Values on a grid, row 0 at the bottom, that scans are scored against.
#[pyclass(name = "LikelihoodField", module = "simulator._core", frozen)]
pub struct PyLikelihoodField(LikelihoodField);

type Triple = (f64, f64, f64);

fn rows<const N: usize>(array: &PyReadonlyArray2<'_, f64>, what: &str) -> PyResult<Vec<[f64; N]>> {
    if array.shape()[1] != N {
        return Err(PyValueError::new_err(format!(
            "{what} must have {N} columns, not {}",
            array.shape()[1]
        )));
    }
    let view = array.as_array();
    Ok(view
        .rows()
        .into_iter()
        .map(|row| std::array::from_fn(|column| row[column]))
        .collect())
}

#[pymethods]
impl PyLikelihoodField {
    #[new]
    fn new(
        values: PyReadonlyArray2<'_, f32>,
        resolution_m: f64,
        origin_m: (f64, f64),
        outside: f32,
    ) -> PyResult<Self> {
        let (height, width) = (values.shape()[0], values.shape()[1]);
        let cells = values.as_array().iter().copied().collect();
        let origin = [origin_m.0, origin_m.1];
        LikelihoodField::new(cells, width, height, resolution_m, origin, outside)
            .map(Self)
            .ok_or_else(|| PyValueError::new_err("a field needs cells and a positive resolution"))
    }

    /// Gaussian bumps of height one around points (n, 2).
    #[staticmethod]
    fn around_points(
        points_m: PyReadonlyArray2<'_, f64>,
        resolution_m: f64,
        sigma_m: f64,
    ) -> PyResult<Self> {
        let points = rows::<2>(&points_m, "points_m")?;
        LikelihoodField::around_points(&points, resolution_m, sigma_m)
            .map(Self)
            .ok_or_else(|| {
                PyValueError::new_err("a field needs finite points and a positive resolution")
            })
    }

    /// Sum of the values at a scan's points (m, 2) for each pose (n, 3).
    fn scores<'py>(
        &self,
        py: Python<'py>,
        poses: PyReadonlyArray2<'_, f64>,
        points_m: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (poses, points) = (
            rows::<3>(&poses, "poses")?,
            rows::<2>(&points_m, "points_m")?,
        );
        let scores = py.detach(|| self.0.scores(&poses, &points));
        Ok(scores.into_pyarray(py))
    }

    /// The best pose around a guess and its mean value per point; the window is its reach [m], its
    /// reach [rad] and the distance of headings [rad].
    #[pyo3(name = "match")]
    fn best_pose(
        &self,
        py: Python<'_>,
        points_m: PyReadonlyArray2<'_, f64>,
        guess: Triple,
        window: Triple,
        least_score: f64,
    ) -> PyResult<Option<(Triple, f64)>> {
        let points = rows::<2>(&points_m, "points_m")?;
        let window = Window {
            guess: [guess.0, guess.1, guess.2],
            reach_m: window.0,
            reach_rad: window.1,
            step_rad: window.2,
            least_score,
        };
        let found = py.detach(|| self.0.best_pose(&points, &window));
        Ok(found.map(|([x, y, heading], score)| ((x, y, heading), score)))
    }
}
