"""An outlook for tests."""

from push_model.outlook import Outlook, Quantiles

OUTLOOK = Outlook(0.97, Quantiles(20.0, 30.0, 35.0, 50.0), Quantiles(0.006, 0.009, 0.01, 0.012),
                  Quantiles(0.005, 0.012, 0.014, 0.02))
