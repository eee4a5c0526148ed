from ._native import (
    Camera as Camera,
    Choice as Choice,
    Dataset as Dataset,
    Epoch as Epoch,
    Model as Model,
    PeelnetError as PeelnetError,
    Recommendation as Recommendation,
    Rows as Rows,
    Scene as Scene,
    Training as Training,
    __version__ as __version__,
    adapter_name as adapter_name,
    bench as bench,
    export as export,
    extract as extract,
    methods as methods,
    recommend as recommend,
    render as render,
    samples as samples,
    train as train,
)

__all__: list[str]
