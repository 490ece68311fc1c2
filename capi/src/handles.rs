//! Handles: numbers that look like pointers to C, and are never followed.
//!
//! Each object lives in a table under a number that is used once. A call takes a share of the object, so
//! freeing it elsewhere meanwhile ends only the name. Tables are behind one short lock each.

use super::status::{Fault, ISYM_ERROR_HANDLE, ISYM_ERROR_NULL, Result};
use std::collections::BTreeMap;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

/// Numbers differ by this, so that they are as aligned as any pointer.
const STEP: usize = 16;

/// The number of the next handle of any kind.
static NEXT: AtomicUsize = AtomicUsize::new(STEP);

/// The live objects of one kind: `Name` is the type that C sees.
pub struct Table<Name, Object> {
    kind: &'static str,
    objects: Mutex<BTreeMap<usize, Arc<Object>>>,
    name: PhantomData<fn(Name)>,
}

impl<Name, Object> Table<Name, Object> {
    /// An empty table of objects that messages call `kind`.
    pub const fn new(kind: &'static str) -> Self {
        Table { kind, objects: Mutex::new(BTreeMap::new()), name: PhantomData }
    }

    /// Enters an object and gives its handle.
    pub fn insert(&self, object: Object) -> *mut Name {
        let number = NEXT.fetch_add(STEP, Ordering::Relaxed);
        self.lock().insert(number, Arc::new(object));
        std::ptr::without_provenance_mut(number)
    }

    /// The object of a handle.
    pub fn get(&self, handle: *const Name) -> Result<Arc<Object>> {
        if handle.is_null() {
            return Err(Fault::new(ISYM_ERROR_NULL, format!("the {} is NULL", self.kind)));
        }
        let found = self.lock().get(&handle.addr()).cloned();
        found.ok_or_else(|| self.unknown())
    }

    /// Ends a handle; NULL is none.
    pub fn remove(&self, handle: *const Name) -> Result {
        if handle.is_null() {
            return Ok(());
        }
        // Taken out under the lock, dropped after it.
        let removed = { self.lock().remove(&handle.addr()) };
        removed.map(drop).ok_or_else(|| self.unknown())
    }

    /// Number of live objects.
    pub fn count(&self) -> usize {
        self.lock().len()
    }

    fn unknown(&self) -> Fault {
        let kind = self.kind;
        Fault::new(ISYM_ERROR_HANDLE, format!("the {kind} was freed already, or is no {kind} at all"))
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<usize, Arc<Object>>> {
        // No code of ours panics while it holds the lock; the map is whole in any case.
        self.objects.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

/// How many handles of all kinds are live. For leak checks in tests.
///
/// @return 0 when everything was freed.
#[unsafe(no_mangle)]
pub extern "C" fn isym_handle_count() -> usize {
    use super::{eigen::EIGENS, mesh::MESHES, options::OPTION_SETS, progress::PROGRESSES, result::RESULTS};
    MESHES.count() + OPTION_SETS.count() + PROGRESSES.count() + RESULTS.count() + EIGENS.count()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Name;

    #[test]
    fn a_freed_handle_is_known_as_such_and_never_comes_back() {
        let table = Table::<Name, u32>::new("mesh");
        let first = table.insert(1);
        let kept = table.get(first).unwrap();
        table.remove(first).unwrap();
        assert_eq!(table.get(first).unwrap_err().status, ISYM_ERROR_HANDLE);
        assert_eq!(table.remove(first).unwrap_err().status, ISYM_ERROR_HANDLE);
        let second = table.insert(2);
        assert_ne!(first, second);
        assert_eq!((*kept, *table.get(second).unwrap(), table.count()), (1, 2, 1));
        assert_eq!(table.remove(std::ptr::null()), Ok(()));
        assert_eq!(table.get(std::ptr::null()).unwrap_err().status, ISYM_ERROR_NULL);
    }
}
