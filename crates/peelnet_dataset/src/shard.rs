//! Which work items a shard takes.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::DatasetError;
use crate::manifest::MAX_WORK_ITEMS;

/// One of N independent pieces of a dataset: the work items k with k ≡ I (mod N).
///
/// Shards count from 1 to N.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    /// I, from 1 to `of`.
    pub index: u32,
    /// N.
    pub of: u32,
}

impl Shard {
    /// Shard `index` of `of`.
    ///
    /// # Errors
    /// [`DatasetError::Shard`] if `index` is not from 1 to `of`, or `of` is above [`MAX_WORK_ITEMS`].
    pub fn new(index: u32, of: u32) -> Result<Self, DatasetError> {
        if !(1..=of).contains(&index) || of > MAX_WORK_ITEMS {
            return Err(DatasetError::Shard {
                text: format!("{index}/{of}"),
            });
        }
        Ok(Self { index, of })
    }

    /// Whether this shard writes work item `item`.
    pub const fn contains(self, item: u32) -> bool {
        item % self.of == self.index % self.of
    }

    /// The folder's name, `shard-I-of-N`.
    pub fn folder(self) -> String {
        format!("shard-{}-of-{}", self.index, self.of)
    }

    /// The shard that a folder's name stands for.
    pub fn from_folder(name: &str) -> Option<Self> {
        let (index, of) = name.strip_prefix("shard-")?.split_once("-of-")?;
        let shard = Self::new(index.parse().ok()?, of.parse().ok()?).ok()?;
        (shard.folder() == name).then_some(shard)
    }
}

impl FromStr for Shard {
    type Err = DatasetError;

    fn from_str(text: &str) -> Result<Self, DatasetError> {
        let error = || DatasetError::Shard {
            text: text.to_owned(),
        };
        let (index, of) = text.split_once('/').ok_or_else(error)?;
        Self::new(
            index.parse().map_err(|_| error())?,
            of.parse().map_err(|_| error())?,
        )
        .map_err(|_| error())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

    #[test]
    fn every_item_is_in_one_shard() {
        for item in 0..20 {
            let shards = (1..=3).filter(|&i| Shard::new(i, 3).unwrap().contains(item));
            assert_eq!(shards.count(), 1);
        }
    }

    #[test]
    fn texts() {
        assert_eq!("2/4".parse::<Shard>().unwrap().folder(), "shard-2-of-4");
        assert_eq!(
            Shard::from_folder("shard-2-of-4"),
            Some(Shard { index: 2, of: 4 })
        );
        // Shards count from 1: a scheduler that counts from 0 would write the last one twice with `0` for it.
        for bad in [
            "",
            "1",
            "0/4",
            "5/4",
            "1/0",
            "a/2",
            "-1/2",
            "1/2/3",
            "1/4294967295",
        ] {
            let message = bad.parse::<Shard>().unwrap_err().to_string();
            assert!(message.contains("I/N"), "{message}");
        }
        for bad in ["shard-0-of-4", "shard-01-of-4", "shard-5-of-4", "shard-1"] {
            assert_eq!(Shard::from_folder(bad), None);
        }
    }
}
