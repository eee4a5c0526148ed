use crate::gpu::{
    AdapterRequest, GpuError, OptionalFeature,
    adapter::{self, OPTIONAL_FEATURES},
    cache::PipelineCache,
};
use crate::shaders::Shader;
use std::{
    borrow::Cow,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    task::Waker,
};

/// An open device with its queue. A handle: clones share the device, the errors it reported and the pipelines compiled so far.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The instance that the adapter came from; an application makes its surfaces with it.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// What the adapter says of itself.
    pub info: wgpu::AdapterInfo,
    /// The limits that the device was opened with.
    pub limits: wgpu::Limits,
    /// The limit that [`Gpu::pretend_memory`] set.
    largest_allocation: u64,
    pub(crate) shared: Arc<Shared>,
}

#[derive(Debug, Default)]
pub(crate) struct Shared {
    memory_was_full: AtomicBool,
    first_error: Mutex<Option<GpuError>>,
    lost: Mutex<Option<String>>,
    /// Who draws again when the device is lost.
    waker: Mutex<Option<Waker>>,
    pub(crate) pipelines: PipelineCache,
}

pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

const fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    }
}

impl Gpu {
    /// Opens the adapter that `request` names, with every optional feature that it has.
    ///
    /// # Errors
    /// No driver, no such adapter, or a driver that opens no device.
    pub async fn open_async(request: &AdapterRequest) -> Result<Self, GpuError> {
        let (instance, adapters) = adapter::enumerate().await;
        let adapter = adapter::pick(adapters, request)?;
        Self::on_adapter(instance, adapter).await
    }

    async fn on_adapter(
        instance: wgpu::Instance,
        adapter: wgpu::Adapter,
    ) -> Result<Self, GpuError> {
        let optional = OPTIONAL_FEATURES.iter().map(|f| f.flag);
        let optional = optional.fold(wgpu::Features::empty(), |all, flag| all | flag);
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("peelnet"),
                required_features: optional & adapter.features(),
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await
            .map_err(|source| GpuError::Device {
                adapter: adapter.get_info().name,
                source,
            })?;
        let gpu = Self::from_parts(instance, adapter, device, queue);
        // wgpu's default is to panic. The first error is kept instead and becomes the error of the next read-back.
        let (shared, name) = (Arc::clone(&gpu.shared), gpu.info.name.clone());
        gpu.device
            .on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
                let error = match error {
                    wgpu::Error::OutOfMemory { .. } => GpuError::MemoryFull(name.clone()),
                    error => GpuError::Validation(error.to_string()),
                };
                locked(&shared.first_error).get_or_insert(error);
            }));
        let shared = Arc::clone(&gpu.shared);
        gpu.device.set_device_lost_callback(move |reason, text| {
            locked(&shared.lost).get_or_insert(format!("{reason:?}: {text}"));
            if let Some(waker) = locked(&shared.waker).take() {
                waker.wake();
            }
        });
        Ok(gpu)
    }

    /// The same as [`Gpu::open_async`], waiting for the driver. Not in a browser, where nothing may wait.
    ///
    /// # Errors
    /// See [`Gpu::open_async`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open(request: &AdapterRequest) -> Result<Self, GpuError> {
        pollster::block_on(Self::open_async(request))
    }

    /// Another device of the same adapter, with a queue of its own: work of another thread, which the frames of this device do not wait for.
    ///
    /// # Errors
    /// A driver that opens no second device.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open_another(&self) -> Result<Self, GpuError> {
        let (instance, adapter) = (self.instance.clone(), self.adapter.clone());
        pollster::block_on(Self::on_adapter(instance, adapter))
    }

    /// An application's own device. Its error and device-lost handlers stay the application's: errors of ours arrive there.
    /// [`Gpu::missing`] lists the optional features that the device was opened without, and what that costs.
    pub fn from_parts(
        instance: wgpu::Instance,
        adapter: wgpu::Adapter,
        device: wgpu::Device,
        queue: wgpu::Queue,
    ) -> Self {
        Self {
            info: adapter.get_info(),
            limits: device.limits(),
            instance,
            adapter,
            device,
            queue,
            largest_allocation: u64::MAX,
            shared: Arc::default(),
        }
    }

    /// The optional features that the device was opened without, each with what that costs.
    pub fn missing(&self) -> Vec<OptionalFeature> {
        let all = OPTIONAL_FEATURES.iter().copied();
        all.filter(|f| !self.has(f.flag)).collect()
    }

    /// A command encoder.
    pub fn encoder(&self) -> wgpu::CommandEncoder {
        self.device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Whether the device was opened with an optional feature.
    pub fn has(&self, feature: wgpu::Features) -> bool {
        self.device.features().contains(feature)
    }

    /// Fails with a clear message where an optional feature is missing.
    ///
    /// # Errors
    /// [`GpuError::MissingFeature`], with `hint` as the way out.
    pub fn need(
        &self,
        feature: wgpu::Features,
        what: &str,
        hint: &'static str,
    ) -> Result<(), GpuError> {
        match self.missing().iter().find(|f| f.flag == feature) {
            None => Ok(()),
            Some(missing) => Err(GpuError::MissingFeature {
                what: what.to_owned(),
                feature: missing.name,
                adapter: self.info.name.clone(),
                hint,
            }),
        }
    }

    /// Fails where something needs more than a limit of the adapter, both counted in `unit`.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], with `hint` as the way out.
    pub fn check_limit(
        &self,
        what: impl Into<String>,
        needed: u64,
        limit: u64,
        unit: &'static str,
        hint: &'static str,
    ) -> Result<(), GpuError> {
        if needed <= limit {
            return Ok(());
        }
        Err(GpuError::TooLarge {
            what: what.into(),
            needed,
            limit,
            unit,
            adapter: self.info.name.clone(),
            hint,
        })
    }

    /// From now on allocations of more bytes fail as they do on a GPU whose memory is full, in this handle and clones made from it:
    /// for tests of what then happens.
    pub fn pretend_memory(&mut self, largest_allocation: u64) {
        self.largest_allocation = largest_allocation;
    }

    /// Whether an allocation did not fit the GPU's memory so far, even if its user went on with less.
    pub fn memory_was_full(&self) -> bool {
        self.shared.memory_was_full.load(Ordering::Relaxed)
    }

    /// The error that wgpu reported since the last call, if any.
    ///
    /// # Errors
    /// [`GpuError::Lost`] once the device is lost, else [`GpuError::Validation`] with wgpu's text, or [`GpuError::MemoryFull`].
    pub fn check(&self) -> Result<(), GpuError> {
        if let Some(reason) = locked(&self.shared.lost).as_ref() {
            return Err(GpuError::Lost(reason.clone()));
        }
        let error = locked(&self.shared.first_error).take();
        error.map_or(Ok(()), Err)
    }

    /// Wakes this once the device is lost, for an application that draws only where something changed. An application's own device
    /// ([`Gpu::from_parts`]) reports to the application instead.
    pub fn wake_when_lost(&self, waker: Waker) {
        *locked(&self.shared.waker) = Some(waker);
    }

    /// Allocates; an allocation that does not fit the GPU's memory is an error at once, and the device goes on.
    fn allocate<T>(
        &self,
        label: &str,
        bytes: u64,
        make: impl FnOnce() -> T,
    ) -> Result<T, GpuError> {
        let full = || {
            self.shared.memory_was_full.store(true, Ordering::Relaxed);
            GpuError::OutOfMemory {
                what: label.to_owned(),
                needed: bytes,
                adapter: self.info.name.clone(),
            }
        };
        if bytes > self.largest_allocation {
            return Err(full());
        }
        // A browser reports a full memory later, through the device's error handler: nothing may wait for it there.
        #[cfg(target_arch = "wasm32")]
        return Ok(make());
        #[cfg(not(target_arch = "wasm32"))]
        {
            let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
            let made = make();
            match pollster::block_on(scope.pop()) {
                None => Ok(made),
                Some(_) => Err(full()),
            }
        }
    }

    /// A buffer that shaders can read and write and that can be copied both ways.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] beyond the largest storage binding, [`GpuError::OutOfMemory`] where memory is full.
    pub fn storage(&self, label: &str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        let limits = &self.limits;
        let limit = limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size);
        // A zero-size binding is an error, and an empty frame is not.
        let size = bytes.max(16).next_multiple_of(4);
        let hint = "draw a smaller frame or use an adapter with larger storage bindings";
        self.check_limit(label, size, limit, "bytes", hint)?;
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_SRC
            | wgpu::BufferUsages::COPY_DST;
        self.allocate(label, size, || self.buffer(label, size, usage))
    }

    /// A buffer of so many bytes, whatever the limits.
    pub(crate) fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    /// A buffer with data in it.
    pub fn upload<T: bytemuck::NoUninit>(
        &self,
        label: &str,
        data: &[T],
        usage: wgpu::BufferUsages,
    ) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let size = (bytes.len().max(16) as u64).next_multiple_of(4);
        let buffer = self.buffer(label, size, usage | wgpu::BufferUsages::COPY_DST);
        if !bytes.is_empty() {
            self.queue.write_buffer(&buffer, 0, bytes);
        }
        buffer
    }

    /// Writes elements into a buffer of such, from the element `first` on.
    pub fn write_at<T: bytemuck::NoUninit>(&self, buffer: &wgpu::Buffer, first: usize, data: &[T]) {
        let offset = (first * size_of::<T>()) as u64;
        self.queue
            .write_buffer(buffer, offset, bytemuck::cast_slice(data));
    }

    /// A 2-D texture of `samples` samples a pixel that can be drawn to and read by shaders and, of one sample, copied from.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] beyond the adapter's largest side, [`GpuError::OutOfMemory`] where memory is full.
    pub fn texture(
        &self,
        label: &str,
        format: wgpu::TextureFormat,
        [width, height]: [u32; 2],
        samples: u32,
        extra: wgpu::TextureUsages,
    ) -> Result<wgpu::TextureView, GpuError> {
        let bytes = u64::from(width)
            * u64::from(height)
            * u64::from(samples)
            * u64::from(format.block_copy_size(None).unwrap_or(4));
        let mut usage =
            extra | wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        usage.set(wgpu::TextureUsages::COPY_SRC, samples == 1);
        let descriptor = wgpu::TextureDescriptor {
            label: Some(label),
            size: extent([width, height]),
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        };
        let what = format!("a frame of {width}×{height} pixels");
        let hints = ["pixels a side", "draw a smaller frame"];
        let texture = self.create_texture(&descriptor, bytes, what, hints)?;
        Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
    }

    fn create_texture(
        &self,
        descriptor: &wgpu::TextureDescriptor<'_>,
        bytes: u64,
        what: String,
        [unit, hint]: [&'static str; 2],
    ) -> Result<wgpu::Texture, GpuError> {
        let side = descriptor.size.width.max(descriptor.size.height);
        let limit = self.limits.max_texture_dimension_2d;
        self.check_limit(what, side.into(), limit.into(), unit, hint)?;
        self.allocate(descriptor.label.unwrap_or_default(), bytes, || {
            self.device.create_texture(descriptor)
        })
    }

    /// A texture of 8 bits a channel with its levels of detail, the largest first: size, and texels row by row.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] beyond the adapter's largest side, [`GpuError::OutOfMemory`] where memory is full.
    pub fn image(
        &self,
        label: &str,
        srgb: bool,
        levels: &[([u32; 2], Cow<'_, [u8]>)],
    ) -> Result<wgpu::TextureView, GpuError> {
        let [width, height] = levels.first().map_or([1, 1], |(size, _)| *size);
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let descriptor = wgpu::TextureDescriptor {
            label: Some(label),
            size: extent([width, height]),
            mip_level_count: levels.len().max(1) as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: if srgb {
                format.add_srgb_suffix()
            } else {
                format
            },
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let bytes = levels.iter().map(|(_, texels)| texels.len() as u64).sum();
        let what = format!("the image {label} of {width}×{height} texels");
        let hints = ["texels a side", "make it smaller"];
        let texture = self.create_texture(&descriptor, bytes, what, hints)?;
        for ((size, texels), level) in levels.iter().zip(0..) {
            self.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    mip_level: level,
                    ..texture.as_image_copy()
                },
                texels,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(4 * size[0]),
                    rows_per_image: None,
                },
                extent(*size),
            );
        }
        // What holds the texels on the way is freed after a submission: not all textures' at once.
        self.queue.submit([]);
        Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
    }

    pub(crate) fn shader(&self, shader: &Shader) -> wgpu::ShaderModule {
        self.device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&shader.name),
                source: wgpu::ShaderSource::Wgsl(shader.text.as_str().into()),
            })
    }

    pub(crate) fn layout(
        &self,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> wgpu::PipelineLayout {
        self.device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: layouts,
                immediate_size: 0,
            })
    }
}
