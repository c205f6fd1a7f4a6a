//! Exemplars on disk: kept by content, rebuilt when damaged, bounded.
//!
//! An exemplar's file is named by its key, the hash of everything that it is made from. It
//! begins with the whole key and ends with the hash of all bytes before it, so that a
//! damaged, half-written or exchanged file is found out and built anew. The least recently used files give way when the folder grows too
//! large.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::SystemTime;

use rayon::prelude::*;

use super::bricks::{BrickVolume, PackedVoxel};
use super::lobes::Lobes;
use super::room::{ENDING, USUAL_LIMIT};
use super::set::{ExemplarError, ExemplarSet, Pair, build_exemplar};
use super::voxelise::VoxelGrid;
use crate::job::{Cancelled, Job};
use crate::synthesis::Catalogue;
use crate::{atomic, memory};

/// Changes whenever exemplars built from the same recipe change.
const FORMAT: u32 = 7;
const MAGIC: &[u8; 8] = b"pickglas";

/// Where exemplars come from: the user's cache folder, or built on the spot.
#[derive(Debug, Clone)]
pub struct ExemplarStore {
    pub(super) folder: Option<PathBuf>,
    /// Bytes that the folder may hold where it does not say itself.
    pub(super) usual_limit: u64,
}

impl ExemplarStore {
    /// The store in the user's own cache folder (`PICKGLASS_CACHE` names another one; empty
    /// it names none).
    pub fn user() -> Self {
        Self {
            folder: user_folder(std::env::var_os("PICKGLASS_CACHE")),
            usual_limit: USUAL_LIMIT,
        }
    }

    /// A store in a folder of at most `limit` bytes, unless the folder says another limit.
    pub fn at(folder: impl Into<PathBuf>, limit: u64) -> Self {
        Self {
            folder: Some(folder.into()),
            usual_limit: limit,
        }
    }

    /// A store that keeps nothing.
    pub fn none() -> Self {
        Self {
            folder: None,
            usual_limit: 0,
        }
    }

    /// The exemplars of a pair of yarns that are `needed`: read if they are there and
    /// whole, else built and kept. A cache that cannot be written is no error: exemplars
    /// are built again next time.
    ///
    /// # Errors
    /// When a recipe is not usable or the job is cancelled.
    pub fn get(
        &self,
        catalogue: &Catalogue,
        pair: &Pair,
        grid: VoxelGrid,
        needed: &[bool],
        job: &Job,
    ) -> Result<Arc<ExemplarSet>, ExemplarError> {
        let set = ExemplarSet::new(catalogue, pair, grid)?;
        Ok(self.complete(catalogue, &Arc::new(set), needed, job)?)
    }

    /// The same set with those of the `needed` exemplars that it lacks, read or built as
    /// by [`ExemplarStore::get`].
    ///
    /// # Errors
    /// [`Cancelled`] when the job was.
    pub fn complete(
        &self,
        catalogue: &Catalogue,
        set: &Arc<ExemplarSet>,
        needed: &[bool],
        job: &Job,
    ) -> Result<Arc<ExemplarSet>, Cancelled> {
        let list: Vec<usize> = (0..catalogue.exemplars())
            .filter(|&exemplar| needed.get(exemplar).copied().unwrap_or(false))
            .filter(|&exemplar| set.volumes[exemplar].is_none())
            .collect();
        if list.is_empty() {
            return Ok(Arc::clone(set));
        }
        let (pair, grid) = (&set.pair, set.grid);
        let done = AtomicUsize::new(0);
        let volumes = list
            .par_iter()
            .map(|&exemplar| {
                let volume = self.exemplar(catalogue, pair, &grid, exemplar, job)?;
                let done = 1 + done.fetch_add(1, Ordering::Relaxed);
                job.report("exemplars", done as f32 / list.len() as f32);
                Ok(volume)
            })
            .collect::<Result<Vec<_>, Cancelled>>()?;
        let mut set = ExemplarSet::clone(set);
        for (exemplar, volume) in list.into_iter().zip(volumes) {
            set.put(catalogue, exemplar, Arc::new(volume));
        }
        Ok(Arc::new(set))
    }

    fn exemplar(
        &self,
        catalogue: &Catalogue,
        pair: &Pair,
        grid: &VoxelGrid,
        exemplar: usize,
        job: &Job,
    ) -> Result<BrickVolume, Cancelled> {
        job.check()?;
        let key = key(catalogue, pair, grid, exemplar);
        let path = (self.folder.as_ref()).map(|folder| folder.join(file_name(&key)));
        if let Some(path) = &path
            && let Some(volume) = read(path, &key)
        {
            // Reading is using: the oldest file is the first to go.
            if let Ok(file) = File::options().append(true).open(path) {
                let _ = file.set_modified(SystemTime::now());
            }
            return Ok(volume);
        }
        let volume = build_exemplar(catalogue, pair, grid, exemplar, job)?;
        if let (Some(folder), Some(path)) = (&self.folder, &path) {
            if let Err(error) = write(folder, path, &key, &volume) {
                log::warn!("exemplars are not kept in {}: {error}", folder.display());
            }
            self.make_room(Some(path));
        }
        Ok(volume)
    }
}

fn file_name(key: &blake3::Hash) -> String {
    format!("{}.{ENDING}", &key.to_hex()[..32])
}

/// The hash of everything that an exemplar is made from.
fn key(catalogue: &Catalogue, pair: &Pair, grid: &VoxelGrid, exemplar: usize) -> blake3::Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&FORMAT.to_le_bytes());
    // Recipes are plain numbers: their debug form names every one of them exactly.
    hasher.update(format!("{pair:?} {grid:?}").as_bytes());
    let weave = &catalogue.weaves()[exemplar];
    hasher.update(format!("{exemplar} {}x{}:", weave.ends(), weave.picks()).as_bytes());
    for pick in 0..weave.picks() {
        for end in 0..weave.ends() {
            hasher.update(&[u8::from(weave.get(end, pick))]);
        }
    }
    hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.finalize()
}

/// The folder that is named, or the user's own; an empty name names none.
fn user_folder(named: Option<OsString>) -> Option<PathBuf> {
    let named = named.filter(|named| !named.is_empty()).map(PathBuf::from);
    named.or_else(|| {
        let folders = directories::ProjectDirs::from("", "", "pickglass")?;
        Some(folders.cache_dir().join("exemplars"))
    })
}

/// Writes through a hasher.
struct Hashed<W> {
    inner: W,
    hasher: blake3::Hasher,
}

impl<W: Write> Hashed<W> {
    fn put(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.hasher.update(bytes);
        self.inner.write_all(bytes)
    }

    fn put_list<T: bytemuck::Pod>(&mut self, list: &[T]) -> std::io::Result<()> {
        self.put(&(list.len() as u64).to_le_bytes())?;
        self.put(bytemuck::cast_slice(list))
    }
}

fn write(
    folder: &Path,
    path: &Path,
    key: &blake3::Hash,
    volume: &BrickVolume,
) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    let temporary = atomic::temporary(folder)?;
    let mut out = Hashed {
        inner: BufWriter::new(temporary),
        hasher: blake3::Hasher::new(),
    };
    out.put(MAGIC)?;
    out.put(key.as_bytes())?;
    let (size, index, voxels, lobes) = volume.parts();
    out.put_list(&size.map(|n| n as u32))?;
    out.put_list(index)?;
    out.put_list(voxels)?;
    out.put_list(lobes)?;
    let hash = out.hasher.finalize();
    out.inner.write_all(hash.as_bytes())?;
    let temporary = out
        .inner
        .into_inner()
        .map_err(std::io::IntoInnerError::into_error)?;
    temporary.persist(path)?;
    Ok(())
}

/// Takes lists off a file's bytes.
struct Parts<'a>(&'a [u8]);

impl Parts<'_> {
    fn count(&mut self) -> Option<usize> {
        let (count, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        usize::try_from(u64::from_le_bytes(*count)).ok()
    }

    fn list<T: bytemuck::Pod>(&mut self) -> Option<Vec<T>> {
        let bytes = self.count()?.checked_mul(size_of::<T>())?;
        let (list, rest) = self.0.split_at_checked(bytes)?;
        self.0 = rest;
        Some(bytemuck::pod_collect_to_vec(list))
    }
}

/// The exemplar in a file, or `None` when there is none, it is damaged or it is another's.
fn read(path: &Path, key: &blake3::Hash) -> Option<BrickVolume> {
    let length = fs::metadata(path).ok()?.len();
    memory::ask(length, || path.display().to_string()).ok()?;
    let bytes = fs::read(path).ok()?;
    let own = |content: &[u8]| {
        let content = content.strip_prefix(MAGIC)?;
        content.strip_prefix(key.as_bytes()).map(<[u8]>::len)
    };
    let whole = bytes
        .split_last_chunk::<32>()
        .filter(|(content, hash)| blake3::hash(content).as_bytes() == *hash)
        .and_then(|(content, _)| Some(&content[content.len() - own(content)?..]));
    let Some(content) = whole else {
        log::warn!("{} is damaged and is built again", path.display());
        return None;
    };
    let mut parts = Parts(content);
    let size: [u32; 3] = parts.list::<u32>()?.try_into().ok()?;
    let (index, voxels) = (parts.list::<u32>()?, parts.list::<PackedVoxel>()?);
    let lobes = parts.list::<Lobes>()?;
    let volume = BrickVolume::from_parts(size.map(|n| n as usize), index, voxels, lobes)?;
    parts.0.is_empty().then_some(volume)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Family;
    use crate::exemplar::common_grid;
    use crate::yarn::YarnRecipe;

    fn small() -> (Catalogue, Pair, VoxelGrid) {
        let catalogue = Catalogue::paper();
        let recipe = YarnRecipe::family(Family::Cotton, 0.3);
        let pair = Pair {
            warp: recipe.clone(),
            weft: recipe,
        };
        let pairs = [pair.clone()];
        let grid = common_grid(&catalogue, &pairs, glam::Vec2::splat(0.4), 3).unwrap();
        (catalogue, pair, grid)
    }

    fn only_file(folder: &Path) -> PathBuf {
        fs::read_dir(folder)
            .unwrap()
            .next()
            .unwrap()
            .unwrap()
            .path()
    }

    /// The plain first exemplar alone.
    fn get(store: &ExemplarStore, pair: &Pair) -> Arc<ExemplarSet> {
        let (catalogue, _, grid) = small();
        store
            .get(&catalogue, pair, grid, &[true], &Job::new())
            .unwrap()
    }

    #[test]
    fn an_exemplar_comes_back_as_it_was_and_damage_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let store = ExemplarStore::at(folder.path(), USUAL_LIMIT);
        let (_, pair, _) = small();
        let built = get(&store, &pair);
        assert!(built.volumes[1].is_none());
        let path = only_file(folder.path());
        let (catalogue, _, grid) = small();
        let key = key(&catalogue, &pair, &grid, 0);
        assert!(built.volumes[0].as_deref() == read(&path, &key).as_ref());

        // One bit anywhere, or a cut, and the file is not used but replaced.
        let whole = fs::read(&path).unwrap();
        for at in [0, 9, whole.len() / 2, whole.len() - 1] {
            let mut damaged = whole.clone();
            damaged[at] ^= 4;
            fs::write(&path, &damaged).unwrap();
            assert!(read(&path, &key).is_none(), "byte {at}");
        }
        fs::write(&path, &whole[..whole.len() / 3]).unwrap();
        assert!(read(&path, &key).is_none());
        get(&store, &pair);
        assert_eq!(fs::read(&path).unwrap(), whole);
    }

    #[test]
    fn case_20_an_empty_variable_names_no_folder() {
        assert_eq!(user_folder(Some(OsString::new())), user_folder(None));
        assert_ne!(user_folder(None), Some(PathBuf::new()));
        let named = user_folder(Some(OsString::from("/there")));
        assert_eq!(named, Some(PathBuf::from("/there")));
    }

    #[test]
    fn case_20_exchanged_files_are_not_believed() {
        let folder = tempfile::tempdir().unwrap();
        let store = ExemplarStore::at(folder.path(), USUAL_LIMIT);
        let (_, pair, _) = small();
        let other = Pair {
            warp: YarnRecipe::family(Family::Linen, 0.3),
            ..pair.clone()
        };
        let (first, second) = (get(&store, &pair), get(&store, &other));
        let files: Vec<PathBuf> = (fs::read_dir(folder.path()).unwrap())
            .map(|entry| entry.unwrap().path())
            .collect();
        let [one, two] = &files[..] else {
            panic!("two files")
        };
        let held = [one, two].map(|path| fs::read(path).unwrap());
        assert!(held[0] != held[1], "unlike exemplars");
        fs::write(one, &held[1]).unwrap();
        fs::write(two, &held[0]).unwrap();
        assert!(get(&store, &pair).volumes[0] == first.volumes[0]);
        assert!(get(&store, &other).volumes[0] == second.volumes[0]);
        // Built again, they are what they were.
        assert_eq!([one, two].map(|path| fs::read(path).unwrap()), held);
    }

    #[test]
    fn what_a_dead_program_left_half_written_goes() {
        let folder = tempfile::tempdir().unwrap();
        let left = folder.path().join(".pickglass-gone.tmp");
        fs::write(&left, b"half").unwrap();
        get(&ExemplarStore::at(folder.path(), USUAL_LIMIT), &small().1);
        assert!(!left.exists());
    }

    #[test]
    fn the_folder_is_bounded_and_the_newest_stays() {
        let folder = tempfile::tempdir().unwrap();
        let store = ExemplarStore::at(folder.path(), 1);
        let (_, pair, _) = small();
        get(&store, &pair);
        let first = only_file(folder.path());
        get(
            &store,
            &Pair {
                warp: YarnRecipe::family(Family::Linen, 0.3),
                ..pair
            },
        );
        assert!(!first.exists());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_no_error() {
        let (_, pair, _) = small();
        let set = get(&ExemplarStore::at("/proc/none", USUAL_LIMIT), &pair);
        assert!(set.volumes[0].is_some());
    }
}
