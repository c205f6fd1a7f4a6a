//! Volumes for the tests: a box of voxels that follow a rule, and what programs of others
//! are told about them.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::fs;
use std::path::{Path, PathBuf};

use glam::{DVec3, UVec3, Vec3};
use pickglass::hash::mix;
use pickglass::volume::source::{CellBox, Frame, SourceVoxel, VoxelSource};

/// Voxels by rule: about a third have matter, each of one of three yarns.
pub struct Rule {
    pub frame: Frame,
    pub albedos: Vec<Vec3>,
    /// A voxel that is denser than the rule says.
    pub changed: Option<UVec3>,
    /// Share of voxels with matter, in 256ths.
    pub filled: u64,
}

impl Rule {
    pub fn new(size: UVec3) -> Self {
        Self {
            frame: Frame {
                size,
                origin_mm: DVec3::new(1.5, -2.25, -0.125),
                edge_mm: 0.0125,
            },
            albedos: vec![
                Vec3::new(0.9, 0.5, 0.25),
                Vec3::new(0.125, 0.75, 1.0),
                Vec3::splat(0.5),
            ],
            changed: None,
            filled: 85,
        }
    }

    pub fn voxel(&self, cell: UVec3) -> SourceVoxel {
        let id = u64::from(cell.x) | u64::from(cell.y) << 20 | u64::from(cell.z) << 40;
        let bits = mix(id);
        if bits & 255 >= self.filled && self.changed != Some(cell) {
            return SourceVoxel::EMPTY;
        }
        let part = |shift: u32| ((bits >> shift) & 255) as f32 / 255.0;
        let direction = Vec3::new(part(8) - 0.5, part(16) - 0.5, part(24) + 0.01);
        let yarn = (bits >> 40) as i32 & 1;
        SourceVoxel {
            sigma: if self.changed == Some(cell) {
                99.0
            } else {
                5.0 + 90.0 * part(32)
            },
            direction: direction.normalize_or(Vec3::Z),
            alpha: [0.125, 0.5][yarn as usize],
            yarn,
        }
    }
}

impl VoxelSource for Rule {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn albedos(&self) -> &[Vec3] {
        &self.albedos
    }

    fn densest(&self) -> f32 {
        100.0
    }

    fn fill(&self, cells: CellBox, voxels: &mut [SourceVoxel]) {
        let CellBox { low, size } = cells;
        let places = (0..size.y).flat_map(|y| {
            (0..size.z).flat_map(move |z| (0..size.x).map(move |x| UVec3::new(x, y, z)))
        });
        for (place, out) in places.zip(voxels) {
            *out = self.voxel(low + place);
        }
    }
}

/// Every voxel of a source, x fastest, then y, then z.
pub fn all(source: &dyn VoxelSource) -> Vec<SourceVoxel> {
    let size = source.frame().size;
    let cells = CellBox {
        low: UVec3::ZERO,
        size,
    };
    let mut voxels = vec![SourceVoxel::EMPTY; cells.voxels()];
    source.fill(cells, &mut voxels);
    let mut sorted = Vec::with_capacity(voxels.len());
    for z in 0..size.z {
        for y in 0..size.y {
            for x in 0..size.x {
                sorted.push(voxels[((y * size.z + z) * size.x + x) as usize]);
            }
        }
    }
    sorted
}

/// Writes what a reader should find: raw little-endian numbers and the frame as JSON.
pub fn write_truth(folder: &Path, source: &dyn VoxelSource) {
    fs::create_dir_all(folder).unwrap();
    let voxels = all(source);
    let put = |name: &str, numbers: &dyn Fn(&SourceVoxel) -> Vec<f32>| {
        let bytes: Vec<u8> = voxels
            .iter()
            .flat_map(numbers)
            .flat_map(f32::to_le_bytes)
            .collect();
        fs::write(folder.join(name), bytes).unwrap();
    };
    let albedo = |voxel: &SourceVoxel| match usize::try_from(voxel.yarn) {
        Ok(yarn) => source.albedos()[yarn],
        Err(_) => Vec3::ZERO,
    };
    put("sigma.f32", &|v| vec![v.sigma]);
    put("albedo.f32", &|v| albedo(v).to_array().to_vec());
    put("sggx.f32", &|v| v.sggx().to_vec());
    put("direction.f32", &|v| v.direction.to_array().to_vec());
    put("alpha.f32", &|v| vec![v.alpha]);
    put("yarn.f32", &|v| vec![v.yarn as f32]);
    let Frame {
        size,
        origin_mm,
        edge_mm,
    } = source.frame();
    let text = format!(
        "{{\"size\": {:?}, \"origin\": {:?}, \"edge\": {edge_mm}, \"densest\": {}}}",
        size.to_array(),
        origin_mm.to_array(),
        source.densest()
    );
    fs::write(folder.join("frame.json"), text).unwrap();
}

/// Names of what lies in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// The Python that has the readers: `PICKGLASS_VOLUMES_PYTHON`, or the environment that
/// `tests/run.sh` makes.
pub fn python() -> Option<PathBuf> {
    let named = std::env::var_os("PICKGLASS_VOLUMES_PYTHON").map(PathBuf::from);
    let made = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/peers/bin/python");
    named.or(Some(made)).filter(|path| path.exists())
}
